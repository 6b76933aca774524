"""Preview of a scan while it runs, and what is shown of it afterwards."""
