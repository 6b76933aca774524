"""What a window shows of a scan and of its features. Light to import."""
