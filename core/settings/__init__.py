"""Every setting of the steps, once: files, flags and forms are made from the table in `core.settings.options`."""
