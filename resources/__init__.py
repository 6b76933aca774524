"""Files that ship with Trisect, found through importlib.resources."""
