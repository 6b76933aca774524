"""The network: all sweeps in one adjustment, tied to the fan and to each other by their crossings."""
