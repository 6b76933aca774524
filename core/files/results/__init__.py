"""The files of results, written and read: calibrations, cloud, mesh, gauge, inspection, run."""
