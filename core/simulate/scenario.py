"""Scenario of a simulated recording: one frozen description from which every picture follows, byte for byte."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.limits import TOML_BYTES
from core.files.reading import read_text, toml_of
from core.messages import Message
from core.simulate.effects.boards import NO_BOARDS, BoardsBeside
from core.simulate.effects.carrier import NO_CARRIER, CarrierBeside
from core.simulate.effects.laser import GAUSSIAN_LASER, LaserEffects
from core.simulate.effects.lens import IDEAL_LENS, LensEffects
from core.simulate.effects.plates import TRUE_PLATES, PlateEffects
from core.simulate.effects.ranges import require_ranges
from core.simulate.effects.room import STEADY_ROOM, RoomEffects
from core.simulate.effects.sensor import IDEAL_SENSOR, SensorEffects
from core.simulate.effects.setup import USUAL_SETUP, Setup
from core.simulate.effects.transport import ONE_WAY, Transport
from core.simulate.effects.warming import NO_WARMING, Warming

OBJECTS = ("block", "narrow-block", "steps", "sphere", "cylinder", "mask", "stl", "plane")
"""Objects that can stand on the table."""

CAMERA_TARGETS = ("checkerboard", "charuco", "circle_grid")
PLANE_TARGETS = ("black_square", *CAMERA_TARGETS)

YAW_DEG = 4.0
"""Degrees by which the object is turned on the table: no part is put down quite straight."""


GAUGE_TOLERANCE_MM = 0.2
"""Stated for a simulated gauge block."""


@dataclass(frozen=True, slots=True)
class Scenario:
    """Description of a recording to be simulated.

    Parameters
    ----------
    object
        One of OBJECTS; `stl_path` names the file of an "stl".
    height_mm
        Height of a block, diameter of a sphere or of a lying cylinder, height of the mask.
    seed
        All chance in the pictures comes from it.
    scale
        Picture size over 3840 × 2748.
    frames, camera_views, plane_poses
        How many pictures of each kind.
    noise
        Factor on shot and read noise: 1 as in a real camera, 0 for none.
    speckle
        Contrast of the lasers' speckle; 0 for none.
    bits
        8 or 16.
    ambient_grey
        8-bit grey level of a white surface in the room's light during the scan.
    texture
        Relative unevenness (standard deviation) of the albedo of table and object.
    camera_target, plane_target
        Kinds of plates, as in rig.toml.
    published_planes
        Take the paper's eq. (6) as printed, angles 4.929° and 4.919°, instead of an exact 5° pencil.
    fan_bow
        How the fan's sheets leave their planes: `core.simulate.rig.Beam.bow`. At 0.05 its lines are bent by about
        0.3 mm over the objects.
    reference
        Write scan/reference.png, the fan alone.
    check_poses
        How many pictures of an interim check are taken between calibration and scan.
    turned_urad, drifted_px
        What has changed between the calibration and these pictures and the scan: the fan's laser turned about its
        emitter and the camera's x axis, and the picture moved on the sensor to the right, and 0.6 times as far down.
    readout_ms, exposure_ms
        Time from the first to the last row of a picture of the scan (71 ms in the paper's camera at 14 frames/s), and
        time each row collects light: what the moving hand does to the stripe meanwhile.
    hand_mm_s, tremor_mm
        Speed of the hand, and amplitude of its tremor of 8 to 12 Hz (0.35 mm is usual): `core.simulate.hand_motion`.
    moved_frame
        From this frame on something is moved: object, table or camera.
    lifted_mm, pushed_mm
        The object, off the table along its normal and aside.
    table_mm
        The table with the object on it, away from the camera along its normal.
    bumped_px
        The camera: its picture moved by so many px to the right, and 0.6 times as far down.
    inner_share, inner_mm, gloss, gloss_deg
        What the object's surface does with the lasers' light: `core.simulate.scene.scene.Material`.
    gloss_along_deg, lay_deg
        Of a glossy object that is ground, rolled or brushed: σ of its lobe along the lay, `gloss_deg` then being that
        across it, and how the lay is turned against the object's x axis, on the table. 0 along: it has no lay. Rolled
        brass and aluminium have 1.6° to 6.5° (Ward 1992: α = √2 σ of 0.04 to 0.16), less along than across.
    mirror_share
        Share of the lasers' light that flat sides of the object mirror onto table and object
        (`core.simulate.scene.mirrors`): 0.04 to 0.1 of plastics and enamel, 0.1 to 0.5 of milled and ground metal.
    stated
        rig.toml says that nothing can change and that plates are true; False: it says nothing of either, as most do.
    laser, lens, sensor, room, plates, warming
        What real rigs do beyond that, by subject (`core.simulate.effects`); tables of these names in TOML.
    transport
        What light does beyond a single way: where sheets end, window and hand, interreflection, light that wanders
        through the object; a table as well.
    setup
        How fan, table and hand are turned beside their usual places; a table as well.
    yaw_deg, right_mm, away_mm
        Where the object stands: turned about the table's normal, and moved over the table, from its middle.
    boards
        What lies beside the object, and is known to lie there; a table as well.
    carrier
        The carrier of reference marks that a block stands in, for a second view of it turned over; a table as well.
    fan_lines
        3, or 1: the fan's middle line alone; 0: there is no fan, nor pictures of one.
    hand_laser
        False: frames of the fan alone, and a pose of the plane target on the table, planes/stage.
    travel_mm
        Without the hand-held laser: how far the object is moved away from frame to frame; 0: it stands still.
    """

    object: str = "block"
    height_mm: float = 50.0
    seed: int = 1
    scale: float = 1.0
    frames: int = 60
    camera_views: int = 14
    plane_poses: int = 9
    noise: float = 1.0
    speckle: float = 0.18
    bits: int = 8
    ambient_grey: float = 45.0
    texture: float = 0.02
    camera_target: str = "checkerboard"
    plane_target: str = "black_square"
    published_planes: bool = False
    fan_bow: float = 0.0
    reference: bool = True
    stl_path: str = ""
    yaw_deg: float = YAW_DEG
    right_mm: float = 0.0
    away_mm: float = 0.0
    fan_lines: int = 3
    hand_laser: bool = True
    travel_mm: float = 0.0
    check_poses: int = 0
    turned_urad: float = 0.0
    drifted_px: float = 0.0
    readout_ms: float = 0.0
    exposure_ms: float = 0.0
    hand_mm_s: float = 0.0
    tremor_mm: float = 0.0
    moved_frame: int = 0
    lifted_mm: float = 0.0
    pushed_mm: float = 0.0
    table_mm: float = 0.0
    bumped_px: float = 0.0
    inner_share: float = 0.0
    inner_mm: float = 0.8
    gloss: float = 0.0
    gloss_deg: float = 6.0
    gloss_along_deg: float = 0.0
    lay_deg: float = 0.0
    mirror_share: float = 0.0
    stated: bool = True
    laser: LaserEffects = GAUSSIAN_LASER
    lens: LensEffects = IDEAL_LENS
    sensor: SensorEffects = IDEAL_SENSOR
    room: RoomEffects = STEADY_ROOM
    plates: PlateEffects = TRUE_PLATES
    warming: Warming = NO_WARMING
    setup: Setup = USUAL_SETUP
    transport: Transport = ONE_WAY
    boards: BoardsBeside = NO_BOARDS
    carrier: CarrierBeside = NO_CARRIER

    def __post_init__(self) -> None:
        choices = (
            ("object", OBJECTS),
            ("camera_target", CAMERA_TARGETS),
            ("plane_target", PLANE_TARGETS),
            ("bits", (8, 16)),
            ("fan_lines", (0, 1, 3)),
        )
        for name, allowed in choices:
            if getattr(self, name) not in allowed:
                raise InputError(
                    Message(
                        "simulate.not_one_of",
                        "'{value}' is not one of {allowed}",
                        value=getattr(self, name),
                        allowed=allowed,
                    ),
                    where=name,
                )
        ranges = (
            ("height_mm", 1.0, 120.0),
            ("seed", 0, 2**63 - 1),
            ("scale", 0.1, 2.0),
            ("frames", 0, 100_000),
            ("camera_views", 0, 1000),
            ("plane_poses", 0, 1000),
            ("noise", 0.0, 100.0),
            ("speckle", 0.0, 2.0),
            ("ambient_grey", 0.0, 250.0),
            ("texture", 0.0, 0.3),
            ("fan_bow", -0.5, 0.5),
            ("yaw_deg", -180.0, 180.0),
            ("right_mm", -60.0, 60.0),
            ("away_mm", -60.0, 60.0),
            ("travel_mm", 0.0, 60.0),
            ("check_poses", 0, 100),
            ("turned_urad", -1e5, 1e5),
            ("drifted_px", -50.0, 50.0),
            ("readout_ms", 0.0, 1000.0),
            ("exposure_ms", 0.0, 1000.0),
            ("hand_mm_s", 0.0, 1000.0),
            ("tremor_mm", 0.0, 10.0),
            ("moved_frame", 0, 100_000),
            ("lifted_mm", -20.0, 20.0),
            ("pushed_mm", -20.0, 20.0),
            ("table_mm", -20.0, 20.0),
            ("bumped_px", -50.0, 50.0),
            ("inner_share", 0.0, 1.0),
            ("inner_mm", 0.0, 5.0),
            ("gloss", 0.0, 1000.0),
            ("gloss_deg", 0.5, 45.0),
            ("gloss_along_deg", 0.0, 45.0),
            ("lay_deg", -180.0, 180.0),
            ("mirror_share", 0.0, 1.0),
        )
        require_ranges(self, ranges)
        if self.sensor.jpeg_quality and self.bits == 16:
            raise InputError(Message("simulate.jpeg_is_8_bit", "JPEG files hold 8 bits"), where="sensor.jpeg_quality")
        if self.object == "stl" and not self.stl_path:
            raise InputError(
                Message("simulate.no_stl_path", "an STL object needs the path of its file"), where="stl_path"
            )

    def with_effects_of(self, other: Scenario) -> Scenario:
        """Copy laser, lens, sensor, room, plates, warming, setup, transport and boards from the scenario `other`."""
        effects = {field.name: getattr(other, field.name) for field in fields(other) if is_dataclass(field.default)}
        return replace(self, **effects)

    @property
    def key(self) -> str:
        """Hash of all fields of the scenario, shortened to a few digits."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:16]

    @classmethod
    def from_toml(cls, text: str, where: Path | str = "scenario") -> Scenario:
        """Read a scenario from a TOML text, keys as the fields; InputError that names `where` if it is wrong.

        Raises
        ------
        InputError
            If it is no TOML, has an unknown key or a value of the wrong type.
        """
        return cls(**_typed(cls, toml_of(text, where), where))

    @classmethod
    def read(cls, path: Path) -> Scenario:
        """Read a scenario from a TOML file; InputError if it cannot be read, or has an unknown key or a wrong value."""
        return cls.from_toml(read_text(path, most=TOML_BYTES), path)


def _typed(kind: type, values: Mapping[str, Any], where: Path | str, within: str = "") -> dict[str, Any]:
    """The fields of the dataclass `kind` that `values` gives, tables as the dataclasses they are of."""
    known: dict[str, Any] = {field.name: field.default for field in fields(kind)}
    found = dict(values)
    for name, value in values.items():
        if name not in known:
            raise InputError(
                Message("simulate.unknown_field", "'{name}' is not a field of a scenario", name=within + name),
                where=where,
            )
        default, wanted = known[name], type(known[name])
        table = is_dataclass(default)
        fits = isinstance(value, dict if table else wanted) or (wanted is float and isinstance(value, int))
        if not fits or (isinstance(value, bool) and wanted is not bool):
            raise InputError(
                Message(
                    "simulate.wrong_type",
                    "{name} = {value} is not of type {kind}",
                    name=within + name,
                    value=repr(value),
                    kind="table" if table else wanted.__name__,
                ),
                where=where,
            )
        if table:
            found[name] = wanted(**_typed(wanted, value, where, f"{name}."))
    return found
