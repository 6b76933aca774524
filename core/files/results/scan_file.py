"""scan.npz: what a scan's pictures showed and how it was solved, as plain arrays.

With it a scan can be solved again with another calibration, to see what the calibration's uncertainty does to a
thickness, without its pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.files.arrays_file import (
    Arrays,
    pack_messages,
    pack_texts,
    read_arrays,
    real,
    texts,
    truth,
    unpack_messages,
    unpack_texts,
    unpacking,
    whole,
    write_arrays,
    wrong_shape,
)
from core.files.results.scan_features import FEATURES_MEMBERS, pack_features, unpack_features
from core.findings.of_proof import DAY
from core.findings.proof import SCAN_UNKNOWN, Doubt, Doubts, ScanFacts, notes_of
from core.inspect.causes import CALIBRATIONS
from core.messages import Command, Message
from core.model.arrays import Array
from core.scan.common_errors import CommonErrors
from core.scan.features.extraction import ScanFeatures
from core.scan.first_cause import Cause, Causes, Suspect
from core.scan.known_planes.points_on_planes import PlaneAgreement
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.part_light import PartLight
from core.scan.plane_check import PlaneCheck, PlaneOff

_TODO = Message(
    "advice.measure_scan_first", "measure the scan first{command}", command=Command("trisect scan SET --out DIR")
)
_NO_FRAME = -1
"""Stands in place of a frame's number where there is none."""
_FACTS = tuple(one.name for one in fields(ScanFacts) if one.name != "of_the_day")
_COMMON = ("sources", "cameras", "fans", "sweeps")
_OLDER_SOURCES = {str(cause): source for source, cause in CALIBRATIONS.items()}
"""Files of earlier versions call them as budgets do."""
_SPECKLE = tuple(one.name for one in fields(FanSpeckle))


_FACT_MEMBERS = {
    **{f"fact_{name}": truth(optional=True) for name in _FACTS},
    "of_the_day": texts(None, optional=True),
    "of_the_day_facts": texts(None, optional=True),
}
_MEMBERS = {
    **FEATURES_MEMBERS,
    "calibration_id": texts(),
    "pis": real("sweeps", None),
    "covariance": real("planes", "planes"),
    "sweep_frames": whole("sweeps"),
    "fan_line": whole("fan pieces"),
    "shown": whole(),
    "crossings_used": real(None, 2),
    **_FACT_MEMBERS,
    "unsure_share": real(optional=True),
    "cause_suspects": texts("causes", optional=True),
    "cause_shares": real("causes", optional=True),
    "cause_freedoms": whole("causes", optional=True),
    "cause_p": real("causes", optional=True),
    "part_light": real(6, optional=True),
    "second_bounces": whole(None, 2, optional=True),
    "common_sources": texts(None, optional=True),
    "common_cameras": real("displaced", 10, optional=True),
    "common_fans": real("displaced", None, 3, optional=True),
    "common_sweeps": real("displaced", None, None, optional=True),
    "common_bends": real("displaced", None, 3, 3, optional=True),
    "plane_names": texts("known planes", optional=True),
    "plane_points": whole("known planes", 3, optional=True),
    "plane_rms": real("known planes", optional=True),
    "plane_pis": real("known planes", 3, optional=True),
    "plane_outlines": real("known planes", None, 2, optional=True),
    "plane_check": real(3, optional=True),
    "plane_check_names": texts("checked planes", optional=True),
    "plane_check_off": real("checked planes", 4, optional=True),
    "speckle_uv": real("speckle points", 2, optional=True),
    "speckle_cell": whole("speckle points", optional=True),
    "speckle_members": whole("cells", optional=True),
    "speckle_first": whole("speckle points", optional=True),
    "speckle_shares": real("speckle points", None, optional=True),
    "speckle_covariance": real(None, "cells", optional=True),
}


@dataclass(frozen=True, eq=False, slots=True)
class ScanFile:
    """Content of scan.npz.

    Parameters
    ----------
    features
        What the pictures showed.
    pis
        (S, 3) light planes of the sweeps in 1/mm; (S, 3·(1 + K)) where they change with the rows
        (`core.scan.network.read_out`).
    covariance
        (3S, 3S) or larger of them stacked, without what camera and fan have in common.
    sweep_frames
        (S,) the frame of each.
    fan_line
        The line (from 0; −1 unknown) of each of the fan's centrelines.
    crossings_used
        (M, 2) pixels of the crossings of the shown frame that were used.
    shown
        Index of the frame to show in the report, or None.
    calibration_id
        Names the calibration the scan was measured with.
    common
        What displaced calibrations do to the scan; None if not known.
    features_key
        Names what the features rest on: with the same key they need not be looked for again. Nothing if not known.
    speckle
        What the fan's own points and the sweeps are both wrong by; None if not known.
    facts
        What decides whether anything measured in the scan can prove conformity; what the file lacks is not known.
    second_bounces
        Frame and number of the sweeps' centrelines that were left out as second bounces.
    unsure_share
        Share of the sweeps' points that were left out because they are less sure than the σ cut; 0 if not known.
    causes
        What explains most of what the scan's crossings are off too much, the likeliest first; none where nothing is.
    part_light
        How much wider stripes are on the part than on the table; None if not known.
    planes
        The known planes that were used, and how well the sweeps' points agree with them.
    plane_check
        Of camera and fan by known planes, those that were left out for it included; None if there was none.
    """

    features: ScanFeatures
    pis: Array
    covariance: Array
    sweep_frames: NDArray[np.int64]
    fan_line: tuple[int, ...]
    crossings_used: Array
    shown: int | None
    calibration_id: str
    features_key: str = ""
    common: CommonErrors | None = None
    speckle: FanSpeckle | None = None
    facts: ScanFacts = field(default_factory=ScanFacts)
    second_bounces: tuple[tuple[int, int], ...] = ()
    unsure_share: float = 0.0
    causes: Causes = ()
    part_light: PartLight | None = None
    planes: tuple[PlaneAgreement, ...] = ()
    plane_check: PlaneCheck | None = None


def write_scan(path: Path, scan: ScanFile) -> None:
    """Write a solved scan as scan.npz, the same scan always to the same bytes; InputError if that fails."""
    common, speckle = scan.common, scan.speckle
    arrays: dict[str, NDArray[Any]] = {
        **pack_features(scan.features, scan.features_key),
        "calibration_id": np.array(scan.calibration_id),
        "pis": scan.pis,
        "covariance": scan.covariance,
        "sweep_frames": scan.sweep_frames,
        "fan_line": np.array(scan.fan_line, dtype=np.int64),
        "shown": np.array(_NO_FRAME if scan.shown is None else scan.shown),
        "crossings_used": scan.crossings_used,
        **{f"fact_{name}": np.array(getattr(scan.facts, name)) for name in _known(scan.facts)},
        "of_the_day": pack_messages(notes_of(scan.facts.of_the_day)),
        "of_the_day_facts": pack_texts([doubt.fact for doubt in scan.facts.of_the_day]),
        "unsure_share": np.array(scan.unsure_share),
        **({} if scan.part_light is None else {"part_light": _packed_light(scan.part_light)}),
        **({"second_bounces": np.array(scan.second_bounces)} if scan.second_bounces else {}),
        **(_packed_planes(scan.planes) if scan.planes else {}),
        **({} if scan.plane_check is None else _packed_check(scan.plane_check)),
        **(_packed(scan.causes) if scan.causes else {}),
        **({f"common_{name}": np.asarray(getattr(common, name)) for name in _COMMON} if common else {}),
        **({} if common is None or common.bends is None else {"common_bends": common.bends}),
        **({f"speckle_{name}": getattr(speckle, name) for name in _SPECKLE} if speckle else {}),
    }
    write_arrays(path, arrays)


def read_scan(path: Path) -> ScanFile:
    """Read a solved scan from scan.npz; InputError if it is missing, damaged or wrong.

    Raises
    ------
    InputError
        If it is missing, damaged, lacks an array, or holds values that are not finite or of a wrong shape.
    """
    arrays = read_arrays(path, _MEMBERS, todo=_TODO)
    sweeps, size = arrays["pis"].shape
    size = 3 * max(1, size // 3)
    for name, shape in (("pis", (sweeps, size)), ("covariance", (size * sweeps, size * sweeps))):
        if arrays[name].shape != shape:
            raise InputError(wrong_shape(name, arrays[name], shape), where=path, todo=_TODO)
    with unpacking(path, todo=_TODO):
        return _unpacked(arrays)


def scan_facts_of(path: Path) -> ScanFacts:
    """Read from scan.npz only the facts that verdicts depend on; all unknown without a file, InputError if damaged."""
    if not path.exists():
        return ScanFacts()
    arrays = read_arrays(path, _FACT_MEMBERS, todo=_TODO)
    with unpacking(path, todo=_TODO):
        return _facts(arrays)


def _unpacked(arrays: Arrays) -> ScanFile:
    features = unpack_features(arrays)
    shown = int(arrays["shown"])
    return ScanFile(
        features=features,
        pis=arrays["pis"],
        covariance=arrays["covariance"],
        sweep_frames=arrays["sweep_frames"],
        fan_line=tuple(arrays["fan_line"].tolist()),
        crossings_used=arrays["crossings_used"],
        shown=None if shown == _NO_FRAME else shown,
        calibration_id=str(arrays["calibration_id"]),
        features_key=str(arrays.get("features_key", "")),
        common=_common(arrays, features.image_size),
        speckle=_speckle(arrays),
        facts=_facts(arrays),
        second_bounces=tuple(
            (frame, piece) for frame, piece in arrays.get("second_bounces", np.zeros((0, 2))).tolist()
        ),
        unsure_share=float(arrays.get("unsure_share", 0.0)),
        causes=_causes(arrays),
        part_light=_part_light(arrays),
        planes=_planes(arrays),
        plane_check=_plane_check(arrays),
    )


def _packed_planes(planes: Sequence[PlaneAgreement]) -> dict[str, NDArray[Any]]:
    return {
        "plane_names": pack_texts([one.name for one in planes]),
        "plane_points": np.array([(one.points, one.frames, one.left_out) for one in planes], dtype=np.int64),
        "plane_rms": np.array([one.rms_mm for one in planes]),
        "plane_pis": np.array([one.pi for one in planes]),
        "plane_outlines": np.array([one.outline for one in planes]),
    }


def _planes(arrays: Arrays) -> tuple[PlaneAgreement, ...]:
    if "plane_names" not in arrays:
        return ()
    names = unpack_texts(arrays["plane_names"])
    columns = (arrays[f"plane_{name}"] for name in ("points", "rms", "pis", "outlines"))
    return tuple(
        PlaneAgreement(name, int(points), int(frames), int(left_out), float(rms), pi, outline)
        for name, (points, frames, left_out), rms, pi, outline in zip(names, *columns, strict=True)
    )


def _packed_check(check: PlaneCheck) -> dict[str, NDArray[Any]]:
    return {
        "plane_check": np.array([check.squares, check.freedom, check.sees], dtype=np.float64),
        "plane_check_names": pack_texts([one.name for one in check.planes]),
        "plane_check_off": np.array([(one.mm, one.turn, one.times, one.others_p) for one in check.planes]),
    }


def _plane_check(arrays: Arrays) -> PlaneCheck | None:
    if "plane_check" not in arrays:
        return None
    names, off = unpack_texts(arrays["plane_check_names"]), arrays["plane_check_off"].tolist()
    squares, freedom, sees = arrays["plane_check"].tolist()
    planes = tuple(PlaneOff(name, *row) for name, row in zip(names, off, strict=True))
    return PlaneCheck(planes, squares, int(freedom), sees)


def _packed(causes: Causes) -> dict[str, NDArray[Any]]:
    return {
        "cause_suspects": pack_texts([cause.suspect for cause in causes]),
        "cause_shares": np.array([cause.share for cause in causes], dtype=np.float64),
        "cause_freedoms": np.array([cause.freedom for cause in causes], dtype=np.int64),
        "cause_p": np.array([cause.p for cause in causes], dtype=np.float64),
    }


def _causes(arrays: Arrays) -> Causes:
    """The causes that were compared; those of another version, which this one does not know, are passed by."""
    if "cause_suspects" not in arrays:
        return ()
    rows = (arrays[f"cause_{name}"].tolist() for name in ("shares", "freedoms", "p"))
    known = {one.value: one for one in Suspect}
    return tuple(
        Cause(known[name], *row)
        for name, *row in zip(unpack_texts(arrays["cause_suspects"]), *rows, strict=True)
        if name in known
    )


def _packed_light(light: PartLight) -> Array:
    return np.array([light.wider, light.error, light.behind_mm, *light.table])


def _part_light(arrays: Arrays) -> PartLight | None:
    if "part_light" not in arrays:
        return None
    wider, error, behind_mm, *table = arrays["part_light"].tolist()
    return PartLight(wider, error, behind_mm, np.array(table))


def _known(facts: ScanFacts) -> list[str]:
    return [name for name in _FACTS if getattr(facts, name) is not None]


def _facts(arrays: Arrays) -> ScanFacts:
    known = {name: bool(arrays[f"fact_{name}"]) for name in _FACTS if f"fact_{name}" in arrays}
    return ScanFacts(**known, of_the_day=_of_the_day(arrays))


def _of_the_day(arrays: Arrays) -> Doubts:
    """The facts of the day, each with its note if there is one; of an earlier version's file notes alone.

    Without either it is not known whether all held on the day.
    """
    notes = unpack_messages(arrays["of_the_day"]) if "of_the_day" in arrays else []
    if "of_the_day_facts" not in arrays:
        return tuple(Doubt(DAY, note) for note in notes if note is not None) or (SCAN_UNKNOWN,)
    named = map(Doubt.named, unpack_texts(arrays["of_the_day_facts"]))
    return tuple(
        doubt if note is None else Doubt(doubt.fact, note)
        for doubt, note in zip_longest(named, notes)
        if doubt is not None
    )


def _common(arrays: Arrays, image_size: tuple[int, int]) -> CommonErrors | None:
    """What displaced calibrations do; ValueError if it is not of this scan's sweeps."""
    if "common_sources" not in arrays:
        return None
    cameras, fans, sweeps = (arrays[f"common_{name}"] for name in _COMMON[1:])
    sources = tuple(_OLDER_SOURCES.get(name, name) for name in arrays["common_sources"].tolist())
    common = CommonErrors(image_size, sources, cameras, fans, sweeps, arrays.get("common_bends"))
    if common.sweeps.shape[1] != len(arrays["sweep_frames"]):
        raise ValueError(f"common_sweeps holds {common.sweeps.shape[1]} sweeps, not {len(arrays['sweep_frames'])}")
    if common.sweeps.shape[2] != arrays["pis"].shape[1]:
        raise ValueError(f"common_sweeps has {common.sweeps.shape[2]} numbers a sweep, not {arrays['pis'].shape[1]}")
    return common


def _speckle(arrays: Arrays) -> FanSpeckle | None:
    """What the fan's own points and the sweeps share; ValueError if it is not of this scan's sweeps and cells."""
    if f"speckle_{_SPECKLE[0]}" not in arrays:
        return None
    speckle = FanSpeckle(**{name: arrays[f"speckle_{name}"] for name in _SPECKLE})
    if len(speckle.covariance) != arrays["pis"].size:
        raise ValueError(f"speckle_covariance has {len(speckle.covariance)} rows, not {arrays['pis'].size}")
    return speckle
