"""A made-up scan of a 50 mm block on a table, 560 mm from the camera, and what a report needs besides."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache
from hashlib import sha256

import numpy as np

from core.calibrate.results import CameraCalibration, FanCalibration, PlanePose, ViewQuality
from core.image.stripes.centreline import Centreline
from core.image.targets.target_view import TargetView
from core.inspect.causes import cause_named
from core.inspect.results import Contribution, Face, GaugeResult
from core.messages import Message, plain
from core.model import Camera, Fan, LightPlane, Pose
from core.report.content import Overlay, RepeatLine, ReportContent
from core.scan.results import FrameRecord
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

CAMERA = Camera(
    (1920, 1374),
    np.array([[2494.92, 0.39, 964.37], [0, 2496.74, 639.33], [0, 0, 1]]),
    np.array([0.0815, -0.3809, 0.0042, -0.0004]),
)
TABLE = LightPlane.from_normal([0.02, -0.17, 0.985], 548.0)
TOP = LightPlane.from_normal(TABLE.normal, TABLE.d_mm - 50.012)
FAN = Fan(tuple(LightPlane(np.array([a / 1000, 0.0, (1.62 + 0.02 * a) / 1000])) for a in (-0.18, -0.02, 0.14)))


def surface_depth(rays):
    """Depth of a 50 mm block standing on the table, and where the block is."""
    table, top = TABLE.depths(rays), TOP.depths(rays)
    points = rays * top[:, None]
    block = (np.abs(points[:, 0] + 4) < 30) & (np.abs(points[:, 1] - 2) < 22)
    return np.where(block, top, table), block


@cache
def cloud_and_mesh(step=8, seed=1):
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.arange(300.0, 1620, step), np.arange(180.0, 1200, step))
    uv = np.column_stack([u.ravel(), v.ravel()])
    rays = CAMERA.rays(uv)
    depth, block = surface_depth(rays)
    sigma = 0.008 + 0.03 * (np.hypot(uv[:, 0] - 960, uv[:, 1] - 690) / 900) ** 2
    ripple = 0.012 * np.sin(uv[:, 0] / 90.0) * np.cos(uv[:, 1] / 140.0)
    points = rays * (depth + sigma * rng.standard_normal(len(depth)) + ripple)[:, None]
    count = len(points)
    normals = np.tile(-TABLE.normal, (count, 1))
    cloud = Cloud(points, uv, sigma, np.full(count, 120.0), np.arange(count) % 60, np.arange(count) % 60, normals)
    rows, columns = u.shape
    index = np.arange(count).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])])
    flat = np.ptp(points[triangles, 2], axis=1) < 12
    return cloud, Mesh(points, normals, sigma, triangles[flat]), block


def face(cloud, plane, indices):
    residuals = -plane.distances(cloud.points[indices])
    spread = np.diff(np.quantile(residuals, [0.025, 0.975]))[0] if len(residuals) else np.nan
    rms = np.sqrt(np.mean(residuals**2)) if len(residuals) else np.nan
    return Face(plane, indices, residuals, float(spread), float(rms))


def gauge(cloud, block, **changes):
    budget = (
        Contribution(cause_named("Crossings and centrelines of this scan (network)"), 0.0049, 0.0245),
        Contribution(cause_named("Fan's centrelines (static speckle)"), 0.0082, 0.0410),
        Contribution(cause_named("Light planes of the fan (calibration)"), 0.0061),
        Contribution(cause_named("Camera parameters (calibration)"), 0.0033),
        Contribution(cause_named("Form of the two faces"), 0.00004),
    )
    given = {
        "thickness_mm": 50.0123,
        "u_mm": 0.0118,
        "k": 2.0,
        "upper": face(cloud, TOP, np.flatnonzero(block)),
        "lower": face(cloud, TABLE, np.flatnonzero(~block)),
        "parallelism": np.radians(0.041),
        "budget": budget,
        "nominal_mm": 50.0,
        "tolerance_mm": 0.2,
        "doubts": (),
    }
    return GaugeResult(**(given | changes))


def line(u, v):
    uv = np.column_stack([np.broadcast_to(u, np.shape(v)), v])
    ones = np.ones(len(uv))
    return Centreline(uv, np.tile([1.0, 0.0], (len(uv), 1)), 2 * ones, 120 * ones, 0.05 * ones, ones > 2)


@cache
def overlay():
    rng = np.random.default_rng(3)
    v, u = np.mgrid[0:1374, 0:1920].astype(np.float32)
    picture = 18 + 30 * ((np.abs(u - 950) < 320) & (np.abs(v - 680) < 240)) + rng.normal(0, 3, u.shape)
    rows, columns = np.arange(40.0, 1330.0), np.arange(60.0, 1860.0)
    fan, sweep, sigma, crossings = [], [], [], []
    for start in (660.0, 990.0, 1310.0):
        column = start + 0.06 * (rows - 680) - 55 * (np.abs(rows - 680) < 240) * (abs(start - 990) < 330)
        picture += 170 * np.exp(-(((u - np.interp(v, rows, column)) / 2.4) ** 2) / 2) * (v > 40) * (v < 1330)
        pieces = (slice(0, 398), slice(404, 878), slice(884, None))
        fan.append(tuple(line(column[piece], rows[piece]) for piece in pieces))
    across = 350 + 0.35 * columns + 45 * (np.abs(columns - 950) < 320)
    picture += 140 * np.exp(-(((v - np.interp(u, columns, across)) / 2.4) ** 2) / 2) * (u > 60) * (u < 1860)
    for piece in (slice(0, 568), slice(574, 1206), slice(1212, None)):
        uv = np.column_stack([columns[piece], across[piece]])
        ones = np.ones(len(uv))
        sweep.append(Centreline(uv, np.tile([0.0, 1.0], (len(uv), 1)), 2 * ones, ones, 0.05 * ones, ones > 2))
        sigma.append(0.009 + 0.05 * (np.abs(columns[piece] - 930) / 700) ** 2)
        for pieces in fan:
            for fan_uv in (part.uv for part in pieces):
                gap = fan_uv[:, 1] - np.interp(fan_uv[:, 0], *uv.T, left=np.nan, right=np.nan)
                crossings += [fan_uv[i] for i in np.flatnonzero(gap[1:] * gap[:-1] <= 0)]
    sigma[2][-150:] = np.nan
    picture = np.clip(picture, 0, 255).astype(np.uint8)
    return Overlay("frame_031.png", picture, tuple(fan), tuple(sweep), tuple(sigma), np.array(crossings))


def camera_calibration():
    rng = np.random.default_rng(5)
    deviations = np.array([0.61, 0.60, 0.08, 0.74, 0.69, 0.0011, 0.0093, 0.00011, 0.00012, 0.0])
    views = []
    for number in range(12):
        points = np.column_stack([np.arange(20.0), np.arange(20.0), np.zeros(20)])
        view = TargetView(points, 30 * points[:, :2], np.full(20, 0.05), f"camera/view_{number:02d}.png")
        used = number != 7
        residuals = rng.normal(0, 0.05, (20, 2))
        reason = None if used else plain("the board lies half outside the picture")
        views.append(ViewQuality(view, Pose.identity(), residuals, 0.071 + 0.001 * number, 0.063, 0.4, used, reason))
    return CameraCalibration(CAMERA, np.diag(deviations**2), tuple(views), 0.0747, 0.0653, 0.83, 0.91, 0.031)


def fan_calibration():
    poses = []
    for number in range(8):
        used = number != 3
        moved = Message(
            "fan.target_moved",
            "the target moved by {shift_px:.2f} px between the pictures with the fan off and on",
            shift_px=0.9,
        )
        reason = None if used else moved
        poses.append(
            PlanePose(
                f"planes/pose_{number}",
                Pose.identity(),
                0.06,
                (np.zeros((5, 3)),) * 3,
                (np.zeros(5),) * 3,
                0.03,
                used,
                reason,
            )
        )
    return FanCalibration(
        FAN, FAN, (0.031, 0.028, 0.034), tuple(np.radians([5.0, 5.0])), tuple(np.radians([4.9291, 4.9192])), 0.042,
        True, plain("The free planes meet one pencil of 5° within their uncertainty: the constraint suits this laser"),
        tuple(poses),
    )  # fmt: skip


def hashes():
    names = ["rig.toml", *(f"camera/view_{n:02d}.png" for n in range(12))]
    names += [f"planes/pose_{n}{suffix}.png" for n in range(8) for suffix in ("", "_off")]
    names += ["scan/reference.png", *(f"scan/frame_{n:03d}.png" for n in range(60))]
    return {name: sha256(name.encode()).hexdigest() for name in names}


def frames():
    reasons = {
        4: "truncated picture file",
        17: "no sweep stripe found",
        18: "no sweep stripe found",
        44: "the sweep crosses no fan line",
    }
    return tuple(
        FrameRecord(n, f"frame_{n:03d}.png", n not in reasons, plain(reasons[n]) if n in reasons else None)
        for n in range(60)
    )


def repeats(count=10):
    """Scans of the block, five minutes apart; their mean is 50.012 mm."""
    offsets = np.resize([-0.021, 0.013, 0.002, -0.009, 0.015], count)
    start = datetime(2026, 3, 14, 14, 0, tzinfo=UTC)
    return tuple(
        RepeatLine(f"scan-{n + 1:02d}", 50.012 + offset, 0.024, 2.0, "c3f1a09b22d4", start + timedelta(minutes=5 * n))
        for n, offset in enumerate(offsets)
    )


def block_content(**changes):
    """A report of the block; `changes` replace fields."""
    cloud, mesh, block = cloud_and_mesh()
    content = ReportContent(
        rig={
            "Camera": "1920 × 1374 px, 8 bit grey",
            "Camera target": "checkerboard, 17 × 12 inner corners, squares of 10 mm",
            "Plane target": "black square, side 60 mm, on a light plate",
            "Fixed laser": "fan of 3 lines, 5° apart",
            "Hand-moved laser": "1 line",
        },
        camera=camera_calibration(),
        fan=fan_calibration(),
        cloud=cloud,
        mesh=mesh,
        hashes=hashes(),
        version="0.1.0",
        timestamp=datetime(2026, 3, 14, 15, 9, 26, tzinfo=UTC),
        gauge=gauge(cloud, block),
        overlay=overlay(),
        frames=frames(),
        settings={"method": "network", "σ cut": "0.05 mm", "stripe width": "automatic (2.4 px)",
                  "stripe contrast": "automatic (38 grey levels)", "seed": "0"},
        notes=(plain("1 picture could not be read and was skipped: scan/frame_004.png is truncated."),
               plain("The red channel is saturated on 0.8 % of the stripe; these points weigh nothing.")),
        method="network over all sweeps, tied to the fan",
        part="Gauge block 50 mm",
        serial="GB-50-0417",
        laboratory="Measuring room 2, Werkzeugbau Süd",
        operator="M. Jørgensen",
    )  # fmt: skip
    return replace(content, **changes) if changes else content
