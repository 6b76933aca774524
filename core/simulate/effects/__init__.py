"""What real rigs do that an ideal one does not, by subject; each is off until it is asked for."""
