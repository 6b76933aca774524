"""Surface to verdict: faces, gauge thickness, uncertainty, conformity."""
