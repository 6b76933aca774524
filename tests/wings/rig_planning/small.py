"""A small plan that is predicted in a second or two."""

from core.wings.rig_planning.prediction.design import Design

SMALL = Design(pixels=(960, 687), pixel_um=6.68, views=8, poses=6, sweeps=16)
CUT_MM = 0.2
"""A quarter of the pixels gives points several times as uncertain as the usual cut allows."""

TOML = f"""[plan]
pixels = [960, 687]
pixel_um = 6.68
views = {SMALL.views}
poses = {SMALL.poses}
sweeps = {SMALL.sweeps}
heights_mm = [40, 50]
"""
"""The same in rig.toml, of blocks of two heights."""
