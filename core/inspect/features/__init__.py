"""The kinds of features of an inspection, one module a kind; each measures a `FeatureSpec` in a `Scene`."""
