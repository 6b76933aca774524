"""The only disk code: pictures, recording sets, calibrations, clouds, results."""
