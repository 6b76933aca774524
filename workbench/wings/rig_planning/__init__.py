"""Tools, Plan a rig."""
