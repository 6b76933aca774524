"""Finding and measuring the stripes of one 10.7 MP frame, on one core."""

from __future__ import annotations

from itertools import count

import numpy as np
from scipy.spatial import cKDTree

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import _limits, extract_centrelines
from core.image.stripes.runs import END_TRIM_PX
from core.image.stripes.tracing.linking import link
from core.image.stripes.tracing.ridge import ridge_response
from core.scan.features.crossings import CrossingWindow
from core.scan.features.extraction import FrameReader, saturated_pixels
from core.scan.features.reference import check_reference
from core.scan.surface.triangulate import triangulate
from core.scan.sweeps.tracking import SweepTracker
from core.simulate.scenario import Scenario
from tests.benchmarks.conftest import FullFrame, processor_ms, table
from tests.benchmarks.peers import opencv_steger, skimage_hessian
from tests.scan.centreline_scan import Curve, ExactScan


def found(frame: FullFrame, picture: np.ndarray, saturated: np.ndarray) -> list[np.ndarray]:
    limits = _limits(frame.stripe, frame.noise, knows_saturation=True)
    return link(picture, saturated.view(np.uint8), frame.stripe.stripe_px, frame.stripe.filter_px, limits)


def after_forty_sweeps(full: FullFrame, exact: ExactScan) -> SweepTracker:
    """A tracker of the frame's scan that knows forty other sweeps, nearly all of them anchors."""
    rng = np.random.default_rng(1)
    tracker = SweepTracker(full.reference.fan, exact.rig.camera, exact.rig.fan, CrossingWindow())
    for frame, curves in enumerate(exact.sweeps):
        tracker.add(frame, [curve.measured(0.1, 10.0, rng) for curve in curves if len(curve.uv) > 40])
        if tracker.is_due:
            tracker.adjust()
    return tracker


def test_tracing_against_filtering_every_pixel(benchmark, speckled, capsys):
    """Steger's line points of four stripes, linked, against those of peers that look at every pixel."""
    picture, four = speckled.frame.astype(np.int16), speckled.four
    saturated = saturated_pixels(speckled.frame)
    g, s = speckled.stripe.filter_px, speckled.stripe.stripe_px
    threshold = ridge_response(0.35 * speckled.stripe.contrast, s, g)
    ours = processor_ms(lambda: found(speckled, picture, saturated))
    opencv = processor_ms(lambda: opencv_steger(four, g, threshold), 3)
    skimage = processor_ms(lambda: skimage_hessian(four, g), 1)
    reading = processor_ms(lambda: int(speckled.frame.max()))
    points = sum(map(len, found(speckled, picture, saturated)))
    benchmark(lambda: found(speckled, picture, saturated))
    table(
        capsys,
        f"Finding four stripes, {points} px of them, in 3840 × 2748 px, one core",
        {
            "tracing": f"{ours:8.1f} ms   {1e3 * ours / points:.2f} µs a px of stripe   (required: 5 ms, goal: 2 ms)",
            "OpenCV, Steger on every pixel, not linked": f"{opencv:8.1f} ms   {opencv / ours:.0f} times as long",
            "scikit-image, Hessian of every pixel alone": f"{skimage:8.1f} ms   {skimage / ours:.0f} times as long",
            "reading every pixel once": f"{reading:8.1f} ms   {reading / ours:.2f} of tracing",
        },
    )


def test_a_whole_frame(benchmark, speckled, capsys):
    """One frame against its reference, from the difference to points with σ, and four stripes at once."""
    reader = FrameReader(speckled.reference, speckled.stripe)
    picture = speckled.frame.astype(np.int16)
    saturated = saturated_pixels(speckled.frame)

    def four() -> object:
        return extract_centrelines(picture, speckled.stripe, noise=speckled.noise, saturated=saturated)

    exact = ExactScan.of(Scenario(frames=40, seed=3))
    tracker, number = after_forty_sweeps(speckled, exact), count(100)

    def read() -> tuple[Centreline, ...]:
        return reader((0, ("frame", speckled.frame))).centrelines

    def located(lines: tuple[Centreline, ...]) -> object:
        plane = tracker.add(next(number), lines).plane
        return [triangulate(line, plane.pi, plane.covariance, exact.rig.camera, 0, 0) for line in lines]

    opencv = processor_ms(
        lambda: opencv_steger(speckled.four, speckled.stripe.filter_px, ridge_response(30.0, 2.4, 3.4)), 3
    )
    lines = read()
    difference = speckled.reference.difference(speckled.frame)
    rows = {
        "frame − reference": processor_ms(lambda: speckled.reference.difference(speckled.frame)),
        "the reference still holds": processor_ms(lambda: check_reference(difference, speckled.reference.fan)),
        "one frame read, difference to σ of each point": processor_ms(read),
        "crossings with fan and 40 sweeps, plane, points": processor_ms(lambda: located(lines)),
        "all of a frame (required: 15 ms)": processor_ms(lambda: located(read())),
        "four stripes found": processor_ms(lambda: found(speckled, picture, saturated)),
        "four stripes found and measured": processor_ms(four),
    }
    benchmark(lambda: located(read()))
    shown = {
        name: f"{ms:8.1f} ms   OpenCV's line points alone: {opencv / ms:.0f} times as long" for name, ms in rows.items()
    }
    table(capsys, "One frame, one core", shown)


def test_cost_grows_with_the_stripe_and_not_with_the_picture(benchmark, clean, capsys):
    """The same stripes in larger and larger pictures, and more and more of them in one."""
    g, s = clean.stripe.filter_px, clean.stripe.stripe_px
    limits = _limits(clean.stripe, clean.noise, knows_saturation=True)
    rows = {}

    def drawn(height: int, width: int, stripes: int) -> np.ndarray:
        u, v = np.arange(width), np.arange(1000)[:, None]
        picture = np.zeros((height, width), np.int16)
        for k in range(stripes):
            away = (u - 300.3 - 60 * k - 0.1 * v) / np.hypot(1, 0.1)
            picture[:1000] += (150 * np.exp(-0.5 * (away / s) ** 2)).astype(np.int16)
        return picture

    def cost(picture: np.ndarray) -> tuple[float, int]:
        state = np.full(picture.shape, 0, np.uint8)  # in memory, as a mask of saturated pixels is

        def job() -> list[np.ndarray]:
            return link(picture, state, s, g, limits)

        return processor_ms(job), sum(map(len, job()))

    for height, width in ((1000, 1000), (1400, 2000), (2000, 2800), (2748, 3840), (4000, 5500)):
        ms, points = cost(drawn(height, width, 4))
        rows[f"{height * width / 1e6:5.1f} MP, {points:6d} px of stripe"] = f"{ms:8.2f} ms"
    for stripes in (1, 2, 4, 8, 16):
        ms, points = cost(drawn(2748, 3840, stripes))
        rows[f" 10.6 MP, {points:6d} px of stripe"] = f"{ms:8.2f} ms"
    benchmark(lambda: cost(drawn(1000, 1000, 1)))
    table(capsys, "Finding stripes: the cost's curve", rows)


def to_its_ends(curve: Curve) -> np.ndarray:
    """The true light (N, 2) with the px at its ends that `Curve` leaves out."""
    first, last = curve.uv[0] - curve.uv[1], curve.uv[-1] - curve.uv[-2]
    more = np.arange(1, END_TRIM_PX + 1)[:, None]
    return np.concatenate([curve.uv[0] + more * first, curve.uv, curve.uv[-1] + more * last])


def test_the_stripes_of_the_twin_are_found_whole_and_nothing_else(clean, speckled, capsys):
    """Shares of the true light that is found, and of what is found that is true, within 1.5 px; error over σ."""
    curves = ExactScan.of(Scenario(frames=12, seed=3)).sweeps[5]
    truth, normals = (np.concatenate([getattr(curve, name) for curve in curves]) for name in ("uv", "normal"))
    light = cKDTree(np.concatenate([to_its_ends(curve) for curve in curves]))
    rows = {}
    for name, full in (("without speckle", clean), ("speckle 0.18", speckled)):
        reader = FrameReader(full.reference, full.stripe)
        lines = reader((0, ("frame", full.frame))).centrelines
        found = np.concatenate([line.uv for line in lines])
        sigma = np.concatenate([line.sigma for line in lines])
        trim = int(4 * full.stripe.filter_px)  # ends are cut by 2.5 filter σ, and known to a few px
        inner = np.concatenate([c.uv[trim:-trim] for c in curves if len(c.uv) > 2 * trim + 12 * full.stripe.filter_px])
        recall = np.mean(cKDTree(found).query(inner)[0] < 1.5)
        precision = np.mean(light.query(found)[0] < 1.5)
        apart, nearest = cKDTree(truth).query(found)
        off = np.sum((found - truth[nearest]) * normals[nearest], axis=1)[apart < 1.5]
        rows[name] = (
            f"recall {recall:.4f}, precision {precision:.4f}   (goals: 0.999), "
            f"RMS error {np.sqrt(np.mean(off**2)):.4f} px, σ stated {np.sqrt(np.mean(sigma**2)):.4f} px"
        )
    table(capsys, f"The sweep's stripe against the twin's truth, {len(found)} px", rows)
