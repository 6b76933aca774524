"""Pictures: read one, and find stripes, crossings and targets in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.acquire.channel import Channel
from core.errors import InputError
from core.files import pictures
from core.image.crossings.crossing import Crossing, cross_centrelines
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import UNCOMPRESSED, Compression, estimate_noise, estimate_noise_of_pair
from core.image.stripes.settings import choose_settings
from core.image.targets import Target, detect
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.settings.options import stated_stripe

Picture = NDArray[np.uint8] | NDArray[np.uint16]
"""Grey levels (height, width)."""


def read_picture(path: str | Path, channel: Channel | None = None) -> Picture:
    """Read a picture file as grey levels (height, width) in uint8 or uint16; `channel` picks one of a colour picture.

    Parameters
    ----------
    path
        png, tif, bmp, jpg or pgm; 8 or 16 bit; grey or colour.
    channel
        The channel of a colour picture: "red", "green" or "blue"; None: colour is reduced to grey.

    Returns
    -------
    Picture
        (height, width) uint8 or uint16.

    Raises
    ------
    InputError
        If the file cannot be read, is damaged, or is no such picture.

    Examples
    --------
    >>> picture = read_picture(small.frames[0])
    >>> picture.shape, picture.dtype.name
    ((550, 768), 'uint8')
    """
    return pictures.read_picture(Path(path), channel)


def compression_of(path: str | Path, channel: Channel | None = None) -> Compression:
    """Estimate from a picture file's own tables by how many grey levels its compression errs; zeros if lossless.

    Parameters
    ----------
    path, channel
        As `read_picture` has them.

    Returns
    -------
    Compression
        All zeros for a file that is lossless or cannot be read; hand it to what takes the picture.

    Examples
    --------
    >>> compression_of(small.frames[0]).grey
    0.0
    """
    return pictures.compression_of(Path(path), channel)


def checked_picture(picture: ArrayLike, where: str) -> Picture:
    """Return `picture` as an array if it holds grey levels (rows, columns) in uint8 or uint16; else InputError."""
    array = np.asarray(picture)
    if array.ndim == 2 and array.size and array.dtype in (np.uint8, np.uint16):
        return array
    raise InputError(
        Message(
            "api.no_picture",
            "an array of shape {shape} and type {dtype} is no picture",
            shape=str(array.shape),
            dtype=str(array.dtype),
        ),
        where=where,
        todo=Message("api.advice_picture", "give grey levels (height, width) of type uint8 or uint16, as read_picture"),
    )


def same_size(picture: Picture, other: Picture, where: str) -> None:
    """Raise InputError, naming `where`, unless two pictures have the same size and type."""
    if picture.shape == other.shape and picture.dtype == other.dtype:
        return
    raise InputError(
        Message(
            "api.pictures_differ",
            "the pictures differ: {shape} of {dtype}, and {other_shape} of {other_dtype}",
            shape=str(picture.shape),
            dtype=str(picture.dtype),
            other_shape=str(other.shape),
            other_dtype=str(other.dtype),
        ),
        where=where,
        todo=Message("api.advice_one_size", "give pictures of one camera with the same settings"),
    )


def size_of_camera(picture: Picture, camera: Camera, where: str) -> None:
    """Raise InputError, naming `where`, unless a picture has the image size of the camera."""
    width, height = camera.image_size
    same_size(picture, np.empty((height, width), picture.dtype), where)


def extract_stripes(
    picture: ArrayLike,
    background: ArrayLike | None = None,
    *,
    width_px: float | None = None,
    contrast: float | None = None,
    compression: Compression = UNCOMPRESSED,
) -> tuple[Centreline, ...]:
    """Extract the centrelines of the laser's stripes in a picture, to a fraction of a pixel.

    Parameters
    ----------
    picture
        (height, width) uint8 or uint16.
    background
        The same scene without these stripes, (height, width) of the same type: it is subtracted. None: they are the
        only light stripes.
    width_px, contrast
        Visible width of the stripes in px, and their height above the background in grey levels; None: chosen by the
        picture.
    compression
        Of the files, by `compression_of`: an array does not show it, and σ would be too small.

    Returns
    -------
    tuple of Centreline
        Longest first, each with places `uv` (n, 2), normals, widths and σ in px, and heights; none where none is seen.

    Raises
    ------
    InputError
        If an array is no picture, the two differ in size or type, or width and contrast are not both given and above 0.

    References
    ----------
    C. Steger, An unbiased detector of curvilinear structures, 1998, doi:10.1109/34.659930; the paper, section 2.3.

    Examples
    --------
    >>> import numpy as np
    >>> v, u = np.mgrid[:80, :120]
    >>> across = v - 40.3 - 0.1 * u
    >>> stripe, = extract_stripes((20 + 150 * np.exp(-0.5 * (across / 2.5) ** 2)).astype(np.uint8))
    >>> middle = stripe.uv[len(stripe.uv) // 2]
    >>> bool(abs(middle[1] - 40.3 - 0.1 * middle[0]) < 0.05)
    True
    """
    lit = checked_picture(picture, "picture")
    white = float(np.iinfo(lit.dtype).max)
    light = lit.astype(np.float32)
    if background is None:
        noise = replace(estimate_noise(light), compression=compression)
    else:
        dark = checked_picture(background, "background")
        same_size(lit, dark, "background")
        without = dark.astype(np.float32)
        one = replace(estimate_noise_of_pair(light, without), compression=compression)
        noise = one.of_difference(float(np.median(without)))
        light -= without
    settings = stated_stripe(width_px, contrast, "width_px, contrast") or choose_settings(light, white)
    if settings is None:
        return ()
    return extract_centrelines(light, settings, noise=noise, saturated=lit >= white)


def find_crossings(one: Sequence[Centreline], other: Sequence[Centreline]) -> tuple[Crossing, ...]:
    """Find where the stripes of one picture cross those of another picture of the same still surface.

    Parameters
    ----------
    one, other
        Centrelines as `extract_stripes` gives them.

    Returns
    -------
    tuple of Crossing
        Each with its place `uv` (2,) in px, its covariance (2, 2) in px², and both directions. None where stripes meet
        at a small angle or too near an end.

    References
    ----------
    The paper, section 2.3; covariance of the meeting of two local fits.

    Examples
    --------
    >>> import numpy as np
    >>> v, u = np.mgrid[:120, :120]
    >>> def lit(across):
    ...     return (20 + 150 * np.exp(-0.5 * (across / 2.5) ** 2)).astype(np.uint8)
    >>> crossing, = find_crossings(extract_stripes(lit(v - 60.25)), extract_stripes(lit(u - 55.5)))
    >>> [round(float(each), 1) for each in crossing.uv]
    [55.5, 60.2]
    """
    return tuple(crossing for _, _, crossing in cross_centrelines(list(one), list(other)))


def find_target(picture: ArrayLike, target: Target, *, name: str = "", camera: Camera | None = None) -> TargetView:
    """Find a calibration target in a picture, to a fraction of a pixel.

    Parameters
    ----------
    picture
        (height, width) uint8 or uint16.
    target
        A Checkerboard, Charuco, CircleGrid or BlackSquare.
    name
        What messages call the picture.
    camera
        Where it is known, edges and circles are fitted free of its distortion.

    Returns
    -------
    TargetView
        The marked points (n, 3) in mm on the target, and where they are seen, (n, 2) in px, with σ.

    Raises
    ------
    InputError
        If the array is no picture, has not the camera's size, or does not show the target: a sentence says what it
        shows instead.

    Examples
    --------
    >>> view = find_target(read_picture(small.camera[0]), small.rig.camera_target)
    >>> view.points.shape, view.uv.shape
    ((204, 3), (204, 2))
    """
    seen = checked_picture(picture, name or "picture")
    if camera is not None:
        size_of_camera(seen, camera, "camera")
    return detect(target, seen, name, camera)
