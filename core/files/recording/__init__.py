"""Recording sets: rig.toml, pictures, and what was found in them."""
