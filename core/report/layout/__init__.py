"""How a page is laid out: styles, tables, fonts."""
