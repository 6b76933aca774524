"""plan.toml: what is to be inspected, and the master it is compared with."""
