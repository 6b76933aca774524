"""The numbers of Trisect: importable, scriptable, typed, without any window.

Rooms, from the ground up; each may use the ones above it in this list, never the ones below:

model, image, calibrate, scan, inspect, report, acquire, files, simulate, pipeline, cli.
"""

from core import processor as processor  # before any library of numbers

__version__ = "0.1.0"
