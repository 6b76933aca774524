"""The simulated rig: the paper's camera, the paper's fan, and the model of light and lens.

Camera and fan are those of Sun et al., Sensors 2023, 23, 13, §5.1 and eq. (6), doi:10.3390/s23010013. The sign of the
last term of eq. (6) is a misprint (with it no plane is seen by that camera nearer than 2 m), so the planes are
A x + B y + C z + 1000 = 0, that is π = −(A, B, C)/1000.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.simulate.effects.laser import GAUSSIAN_LASER, LaserEffects

# Sun et al. 2023.
FULL_SIZE = (3840, 2748)
FULL_MATRIX = ((4990.2635, 0.77900164, 1929.2399), (0.0, 4993.9024, 1279.1607), (0.0, 0.0, 1.0))
"""As below: the camera matrix in pixels, with skew."""
DISTORTION = (0.0815, -0.3809, 0.0042, -0.0004)
"""The paper's camera, §5.1: (width, height) in px, A in px, and k1, k2, p1, p2."""
PUBLISHED_COEFFICIENTS = ((0.922, -7.397, -1.429), (1.321, -9.319, -0.992), (1.986, -12.52, -0.263))
"""(A, B, C) of eq. (6), line 1 … 3."""
FAN_ANGLE = np.radians(5.0)
"""rad, nominal, between neighbouring planes."""

# What the paper does not tell; chosen so that things lie in the picture and in the light.
FAN_EMITTER_X_MM = 120.0
"""x of the point on the fan's axis from which its light comes: just outside the lower right corner of the picture."""
FAN_FOCUS_MM, SWEEP_FOCUS_MM = 240.0, 550.0
"""Distances from the emitters at which the fan and the hand-held laser are focused: where the object is."""


@dataclass(frozen=True, eq=False, slots=True)
class Optics:
    """Blur, speckle and noise of the pictures; the defaults are those of a usual industrial camera and lens.

    Lengths on the sensor are given in pixels of the full-resolution camera and scale with it; each pixel size adds
    its own part in quadrature, as micro-lenses and read-out do.

    Parameters
    ----------
    lens_blur_px
        Gaussian σ of the lens in full-resolution pixels.
    pixel_blur_px
        Gaussian σ added at any resolution, in pixels of that resolution; the pixel's own area comes on top.
    speckle_grain_px
        1/e half-width of the speckle's correlation in full-resolution pixels.
    speckle_contrast
        Standard deviation over mean of the speckle seen by one pixel.
    electrons_per_grey
        Photo-electrons per 8-bit grey level.
    read_noise_grey, black_level_grey
        Standard deviation and mean of a dark pixel, in 8-bit grey levels.
    """

    lens_blur_px: float = 0.8
    pixel_blur_px: float = 0.95
    speckle_grain_px: float = 2.0
    speckle_contrast: float = 0.18
    electrons_per_grey: float = 16.0
    read_noise_grey: float = 0.8
    black_level_grey: float = 5.0

    def blur_px(self, scale: float) -> float:
        """Compute the Gaussian σ in px of lens and pixel in a picture scaled by `scale`, but for a pixel's area."""
        return float(np.hypot(self.lens_blur_px * scale, self.pixel_blur_px))

    def grain_px(self, scale: float) -> float:
        """Compute the size in px of speckle grains in a picture scaled by `scale`; at least a pixel's."""
        return float(np.hypot(self.speckle_grain_px * scale, 1.0))


@dataclass(frozen=True, eq=False, slots=True)
class Beam:
    """Sheet of light of a line laser: Gaussian across, focused at one distance, falling off along its fan angle.

    Parameters
    ----------
    sigma_mm
        Gaussian σ across the sheet at its focus.
    focus_mm
        Distance of the focus from the emitter.
    wavelength_mm
        Gives the divergence on both sides of the focus.
    half_angle
        Angle in rad from the middle of the sheet at which the light has fallen to 1/e².
    peak_grey
        8-bit grey levels at the crest at the focus, on a white surface facing the laser, before the lens blurs it.
    bow
        Of a line lens that makes no plane: the light φ rad beside the camera's viewing direction, seen from the
        emitter, leaves the plane by ½ · bow · φ² rad (its "smile"); 0 for a plane.
    section
        What is added to the Gaussian across, or takes its place.
    end_angle, end_fade
        Angle in rad from the middle at which the housing cuts the sheet off, and over which it fades there; 0: it ends
        by itself.
    """

    sigma_mm: float = 0.22
    focus_mm: float = 400.0
    wavelength_mm: float = 650e-6
    half_angle: float = np.radians(60.0)
    peak_grey: float = 300.0
    bow: float = 0.0
    section: LaserEffects = GAUSSIAN_LASER
    end_angle: float = 0.0
    end_fade: float = 0.0

    @property
    def rayleigh_mm(self) -> float:
        """Distance in mm from the focus at which the laser sheet is √2 times as thick."""
        return float(4 * np.pi * self.sigma_mm**2 / self.wavelength_mm)


@dataclass(frozen=True, eq=False, slots=True)
class Rig:
    """Camera, fan and lasers at one picture size; `scale` is 1 at 3840 × 2748.

    `fan_emitter` is the point (3,) in mm, on the fan's axis, from which its three sheets come.
    """

    camera: Camera
    fan: Fan
    fan_emitter: Array
    scale: float
    optics: Optics
    fan_beam: Beam
    sweep_beam: Beam

    @property
    def blur_px(self) -> float:
        """Gaussian σ in px of the blur by lens and pixel in this rig's pictures."""
        return self.optics.blur_px(self.scale)

    @property
    def grain_px(self) -> float:
        """Size in px of speckle grains in this rig's pictures."""
        return self.optics.grain_px(self.scale)


def published_fan() -> Fan:
    """Make the three light planes of the paper's eq. (6), as printed but for the sign.

    Their angles are 4.929° and 4.919°, not quite one pencil.
    """
    return Fan(tuple(LightPlane(-np.array(row) / 1000.0) for row in PUBLISHED_COEFFICIENTS))


def fan_axis(fan: Fan) -> tuple[Array, Array]:
    """Compute the axis of a fan: its point at x = 0 (3,) in mm and its unit direction (3,), towards +x.

    The planes as points π lie on one straight line in π-space; the axis is all X with π·X = 1 for the whole line.
    """
    middle = fan.pis.mean(axis=0)
    along = np.linalg.svd(fan.pis - middle)[2][0]
    direction = np.cross(middle, along)
    direction *= np.sign(direction[0]) / np.linalg.norm(direction)
    point = np.linalg.solve(np.array([middle, along, [1.0, 0.0, 0.0]]), [1.0, 0.0, 0.0])
    return point, direction


def pencil_fan() -> Fan:
    """Make a fan of three planes exactly 5° apart through one axis, nearest to the published planes."""
    published = published_fan()
    point, direction = fan_axis(published)
    planes = []
    middle = published.planes[1].normal
    middle = middle - (middle @ direction) * direction
    middle /= np.linalg.norm(middle)
    turn = np.sign(np.cross(middle, published.planes[2].normal) @ direction) * FAN_ANGLE
    for step in (-1, 0, 1):
        normal = Rotation.from_rotvec(step * turn * direction).apply(middle)
        planes.append(LightPlane(normal / (normal @ point)))
    return Fan(tuple(planes))


def paper_rig(
    scale: float = 1.0,
    *,
    published_planes: bool = False,
    optics: Optics | None = None,
    fan_bow: float = 0.0,
    laser: LaserEffects = GAUSSIAN_LASER,
) -> Rig:
    """Make the paper's rig with pictures resized by `scale` (0.5 gives 1920 × 1374).

    Parameters
    ----------
    scale
        Picture size over 3840 × 2748.
    published_planes
        Take eq. (6) as printed (4.929°, 4.919°) instead of the exact 5° pencil nearest to it.
    optics
        Lens, speckle and noise; the default is a usual industrial camera.
    fan_bow
        Bow of the fan's sheets, see `Beam`.
    laser
        The sections of both lasers.
    """
    camera = Camera(FULL_SIZE, np.array(FULL_MATRIX), np.array(DISTORTION)).scaled(scale)
    fan = published_fan() if published_planes else pencil_fan()
    point, direction = fan_axis(fan)
    emitter = point + direction * (FAN_EMITTER_X_MM / direction[0])
    beam = Beam(focus_mm=FAN_FOCUS_MM, section=laser)
    swept = replace(beam, focus_mm=SWEEP_FOCUS_MM)
    return Rig(camera, fan, emitter, scale, optics or Optics(), replace(beam, bow=fan_bow), swept)
