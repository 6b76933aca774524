"""Lines of stripe points made whole: split at kinks, joined across crossings and holes, smoothed along themselves."""
