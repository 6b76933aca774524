"""Light that wanders through matter: photons followed from collision to collision, in a half space.

A photon enters along the beam and collides at a depth h, the free path times an exponential number; from there it goes
on in all directions alike, a share (the albedo) of it at each collision, until it comes out of the surface, s mm along
it from above its first collision. What comes out at a point X of the surface thus began at X + s − h n, n the outward
normal: it is lit if the sheet passes there. Nothing is refracted or mirrored at the surface.

The same photons are taken for all points, so pictures stay the same byte for byte. Their spread grows with the free
path, and with the number of collisions that the albedo allows: Jensen, Marschner, Levoy and Hanrahan, A practical model
for subsurface light transport, SIGGRAPH 2001, doi:10.1145/383259.383319, section 2.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from core.model.arrays import Array

PHOTONS, FOLLOWED = 64, 4000
"""Photons that stand for all, each with its mirror image, and how many are followed for them and for the share."""
MOST_COLLISIONS = 400
"""After so many a photon is given up."""
FARTHEST_PATHS = 12.0
"""Free paths from where it entered within which a photon comes out, or is left out: it is spread too thinly to see."""


class Walk(NamedTuple):
    """Photons that come out of scattering matter again.

    `depth` (K,) and `aside` (K,) are h and s in free paths, s along one direction of the surface, each with its mirror
    image; `weight` (K,) is what each brings, together `share` of the light that entered.
    """

    depth: Array
    aside: Array
    weight: Array
    share: float


@cache
def walk(albedo: float) -> Walk:
    """Simulate where photons that enter matter of this single-scattering `albedo` leave it again."""
    rng = np.random.default_rng(20_010)
    first = rng.exponential(size=FOLLOWED)
    depth, aside = first.copy(), np.zeros(FOLLOWED)
    weight, out = np.full(FOLLOWED, albedo), np.zeros(FOLLOWED, dtype=np.bool_)
    going = np.arange(FOLLOWED)
    for _ in range(MOST_COLLISIONS):
        step, up = rng.exponential(size=len(going)), rng.uniform(-1.0, 1.0, len(going))
        along = np.sqrt(1 - up**2) * np.cos(rng.uniform(0.0, 2 * np.pi, len(going)))
        below = depth[going] - step * up
        leaves = below <= 0
        part = np.where(leaves, depth[going] / np.maximum(depth[going] - below, 1e-12), 1.0)
        aside[going] += part * step * along
        depth[going] = np.maximum(below, 0.0)
        out[going[leaves]] = True
        going = going[~leaves]
        weight[going] *= albedo
        if not len(going):
            break
    seen = out & (np.abs(aside) < FARTHEST_PATHS) & (first < FARTHEST_PATHS) & (weight > 0)
    share = float(weight[seen].sum() / FOLLOWED)
    if not seen.any():
        return Walk(np.zeros(0), np.zeros(0), np.zeros(0), 0.0)
    kept = rng.choice(np.flatnonzero(seen), PHOTONS, p=weight[seen] / weight[seen].sum())
    mirrored = np.concatenate([aside[kept], -aside[kept]])
    return Walk(np.tile(first[kept], 2), mirrored, np.full(2 * PHOTONS, share / (2 * PHOTONS)), share)
