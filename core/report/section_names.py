"""The sections of a report that can be left out; apart, because a window lists them without needing a report."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

SECTIONS: Mapping[str, str] = MappingProxyType(
    {
        "surface": "Measured surface",
        "frame": "One frame of the scan",
        "points": "Points the results rest on",
        "maps": "Residuals of both faces, or depth and σ of the cloud",
        "deviation": "Deviation from the nominal surface",
        "budget": "Uncertainty budget",
        "repeats": "Repeated scans",
        "studies": "Studies",
        "calibrations": "Calibrations and rig",
        "frames": "Frames and calibration pictures",
        "remarks": "Remarks of the operator",
        "settings": "Software and settings",
        "inputs": "Inputs, each with its hash",
        "signatures": "Signatures",
    }
)
"""Name and title of each section that can be left out, in printing order.

What a reader must not miss is not among them: the result, what it does not cover, warnings, and the hash over all
inputs.
"""
