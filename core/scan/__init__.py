"""Features and model to surface: sweeps, the network, fusion, mesh."""
