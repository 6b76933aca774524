"""Model of the rig: camera, pose, light plane, fan and the rays between them. Millimetres and radians."""

from core.model.camera import Camera
from core.model.fan import Fan
from core.model.light_plane import LightPlane, angle_between
from core.model.pose import Pose

__all__ = ["Camera", "Fan", "LightPlane", "Pose", "angle_between"]
