"""The only code that reads or writes disk: recording sets, results, PLY."""
