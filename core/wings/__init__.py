"""Wings: what is beside the mission. The house imports none of them; `core.wing` brings them in."""
