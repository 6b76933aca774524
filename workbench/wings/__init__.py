"""Pages of the wings. The window imports none of them; `workbench.wing` brings them in."""
