"""Forms: settings, live sources."""
