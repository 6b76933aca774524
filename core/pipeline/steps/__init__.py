"""The steps from a recording set to results, each a module, and all of them in one call (`run`)."""
