"""Calibration targets: found in a picture to sub-pixel, and their pose."""

from core.image.targets.detect import detect
from core.image.targets.kinds import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.pose import PoseEstimate, estimate_pose
from core.image.targets.shift import camera_shift, followed_shift, picture_shift
from core.image.targets.target_view import TargetNotFound

__all__ = [
    "BlackSquare",
    "Charuco",
    "Checkerboard",
    "CircleGrid",
    "PoseEstimate",
    "Rectangle",
    "Target",
    "TargetNotFound",
    "camera_shift",
    "detect",
    "estimate_pose",
    "followed_shift",
    "picture_shift",
]
