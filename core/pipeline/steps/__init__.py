"""The steps from a recording set to results, each a module; all of them in one call: `core.pipeline.run`."""
