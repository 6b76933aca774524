"""The history of a rig: every check of it, by pictures or by an artefact, in one file in the user's own folder.

Layout::

    FOLDER/rigs/NAME.json       of the rig that rig.toml names, else of one calibration by its id

Written whole or not at all. A check of the same pictures with the same calibration takes the place of the one before,
by artefacts if it is of the same characteristic: a stepped block has several heights.
"""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timedelta
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import platformdirs
from pydantic import Field

from core.calibrate.change import RigSpread, Stability
from core.calibrate.rig_spread import FACTORS, most_likely_factor
from core.checks.artefact_check import Artefact, ArtefactCheck, ArtefactKind
from core.checks.control_chart import FEWEST, ControlChart, control_chart
from core.files.atomic import make_folder
from core.files.complaints import checked_json
from core.files.json_text import write_json
from core.files.reading import read_json
from core.files.results.check_file import CheckVerdict, InterimCheck
from core.files.tables import RESULT, Finite, LengthAbove0, OptionalDay, OrNan, Probability, ResultFile, Time
from core.findings.proof import Doubt
from core.inspect.uncertainty.coverage import coverage_factor
from core.messages import Message

DATA = "TRISECT_DATA"
"""Environment variable that names another folder than the user's own, as one that a laboratory shares."""

GIVES_WAY = 1.1
"""A stated stability gives way to checks that show so many times more than the largest of what it states."""
QUIET_DAYS = 59
"""Days of checks from which on a rig may be said to change less than by default. Before, a knock that happens on one
day of twenty is not excluded (0.95⁵⁹ < 0.05), and it turns a mount as far as the default has it."""
_DAY = timedelta(days=1)
_TODO = Message("advice.mend_history", "mend the file, or move it away: the history begins anew then")


@dataclass(frozen=True, slots=True)
class PastCheck:
    """Summary of one check of a rig; lengths as in `core.files.results.check_file.InterimCheck`.

    `celsius` is the temperature of the air; None where nobody took it. Of a check by an artefact `artefact` is its id
    and `e_n` its normalised error, the step is its certified length, and there are no stripes; else there is none.
    `certified_u_mm`, `certified_k`, `certificate` and `due` are what its certificate says; no u of checks before that
    was kept. `kind` and `characteristic` are what it is and what was measured of it, `doubts` the
    facts by which that proves nothing; none of checks before these were kept.
    `likelihoods` are those of `core.calibrate.rig_spread`; None of an artefact, or where no stripe was found.
    `stated_mm` is what change does to a step by the stability in rig.toml, or without one by the default, `default_mm`
    what it does by the default.
    """

    taken_at: Time
    calibration_id: str
    pictures_id: str
    verdict: Annotated[CheckVerdict, Field(description='"passed", "doubtful" or "failed"')]
    p: Probability
    step_mm: LengthAbove0
    offset_px: OrNan = math.nan
    offset_mm: OrNan = math.nan
    error_mm: OrNan = math.nan
    unseen_mm: OrNan = math.nan
    stated_mm: OrNan = math.nan
    celsius: Finite | None = None
    artefact: str = ""
    e_n: OrNan = math.nan
    certified_u_mm: OrNan = math.nan
    certified_k: Annotated[Finite, Field(ge=1, le=10, description="a coverage factor from 1 to 10")] = 2.0
    certificate: str = ""
    due: OptionalDay = None
    likelihoods: Annotated[
        Annotated[tuple[Finite, ...], Field(min_length=len(FACTORS), max_length=len(FACTORS))] | None,
        Field(description=f"{len(FACTORS)} finite numbers"),
    ] = None
    default_mm: OrNan = math.nan
    kind: Annotated[ArtefactKind, Field(description='"block", "sphere" or "step"')] = "block"
    characteristic: str = ""
    doubts: tuple[str, ...] = ()
    laboratory: str = ""
    __pydantic_config__ = RESULT

    @property
    def by_default_mm(self) -> float:
        """Limit in mm by the rig's default stability; of older checks with nothing stated, `stated_mm`."""
        return self.stated_mm if math.isnan(self.default_mm) else self.default_mm

    @property
    def looked_at(self) -> tuple[str, str, str]:
        """Ids of pictures and calibration, and characteristic: a later check with the same three replaces this one."""
        return self.pictures_id, self.calibration_id, self.characteristic

    @property
    def values(self) -> dict[str, Any]:
        """Values of the check by their names in the history file."""
        due = None if self.due is None else self.due.isoformat()
        return {**asdict(self), "taken_at": self.taken_at.isoformat(), "due": due}

    @property
    def of_artefact(self) -> ArtefactCheck | None:
        """The check as one of an artefact against its certificate; None if by pictures, or without a certificate."""
        if not self.artefact or math.isnan(self.certified_u_mm + self.error_mm) or not self.unseen_mm > 0:
            return None
        known = Artefact(
            self.artefact,
            self.step_mm,
            self.certified_k * self.certified_u_mm,
            self.certified_k,
            self.certificate,
            self.due,
            self.kind,
            self.laboratory,
        )
        square = (self.unseen_mm / 2) ** 2 - self.certified_u_mm**2
        day = self.taken_at.astimezone().date()
        u_mm = math.sqrt(max(square, 0.0))
        doubts = tuple(map(Doubt.named, self.doubts))
        return ArtefactCheck(known, self.step_mm + self.error_mm, u_mm, day, self.characteristic, doubts=doubts)

    @classmethod
    def of_measured(
        cls, measured: ArtefactCheck, taken_at: datetime, ids: tuple[str, str], celsius: float | None
    ) -> PastCheck:
        """Make the history's entry of an artefact just measured, with the `ids` of calibration and pictures."""
        known = measured.artefact
        return cls(
            taken_at,
            *ids,
            measured.verdict,
            measured.p,
            known.value_mm,
            error_mm=measured.error_mm,
            unseen_mm=2 * measured.u_error_mm,
            stated_mm=0.0,  # its uncertainty holds what may have changed
            celsius=celsius,
            artefact=known.id,
            e_n=measured.e_n,
            certified_u_mm=known.U_mm / known.k,
            certified_k=known.k,
            certificate=known.certificate,
            due=known.due,
            kind=known.kind,
            characteristic=measured.characteristic,
            doubts=tuple(doubt.fact for doubt in measured.doubts),
            laboratory=known.laboratory,
        )

    @classmethod
    def of(
        cls,
        check: InterimCheck,
        celsius: float | None = None,
        likelihoods: tuple[float, ...] | None = None,
        default_mm: float = math.nan,
    ) -> PastCheck:
        """Make the history's entry of an interim check just made."""
        return cls(
            check.taken_at, check.calibration_id, check.pictures_id, check.verdict, check.p, check.step_mm,
            check.offset_px, check.offset_mm, check.error_mm, check.unseen_mm, check.stated_mm, celsius,
            likelihoods=likelihoods, default_mm=default_mm,
        )  # fmt: skip


class CheckChart(NamedTuple):
    """Control chart of checks by the same means, pictures or one artefact, with the limits for one of them."""

    checks: tuple[PastCheck, ...]
    limits: ControlChart


@dataclass(frozen=True, slots=True)
class RigHistory:
    """Checks of the rig called `name`, in the order their pictures were taken."""

    name: str
    checks: tuple[PastCheck, ...] = ()

    def of_calibration(self, calibration_id: str) -> tuple[PastCheck, ...]:
        """Select the checks made with the calibration `calibration_id`."""
        return tuple(check for check in self.checks if check.calibration_id == calibration_id)

    def artefacts(self, calibration_id: str, when: datetime) -> tuple[ArtefactCheck, ...]:
        """Select, for each artefact measured with the calibration `calibration_id`, the check nearest to `when`."""
        found: dict[str, ArtefactCheck] = {}
        for one in sorted(self.of_calibration(calibration_id), key=lambda one: abs(one.taken_at - when)):
            if one.artefact not in found and (measured := one.of_artefact) is not None:
                found[one.artefact] = replace(measured, outside=self.beyond(one))
        return tuple(found[name] for name in sorted(found))

    def charted(self, check: PastCheck) -> CheckChart:
        """Make the control chart of a check together with the checks it is compared with."""
        return CheckChart(self.like(check), self.chart(check))

    def artefact_charts(self, calibration_id: str) -> tuple[CheckChart, ...]:
        """Make a control chart for each artefact measured with the calibration `calibration_id`."""
        last = {one.artefact: one for one in self.of_calibration(calibration_id) if one.artefact}
        return tuple(self.charted(last[name]) for name in sorted(last))

    def like(self, check: PastCheck) -> tuple[PastCheck, ...]:
        """Select the checks with the same calibration and means (pictures, or one artefact) as `check`."""
        return tuple(one for one in self.of_calibration(check.calibration_id) if one.artefact == check.artefact)

    def chart(self, check: PastCheck) -> ControlChart:
        """Compute the control limits for a check's error in mm from earlier checks like it that have not failed.

        Until there are enough of them, by what is stated of the rig and the check's own uncertainty.
        What is charted is the error of a step in parts of its height, times the height of this one: parts differ.
        """
        before = [
            one.error_mm / one.step_mm * check.step_mm
            for one in self.like(check)
            if one.taken_at < check.taken_at and one.verdict != "failed"
        ]
        return control_chart(np.array(before), math.hypot(check.stated_mm, check.unseen_mm / 2))

    def spread(self, calibration_id: str, when: datetime, stated: Stability | None = None) -> RigSpread | None:
        """Estimate how much the rig changes from its checks by pictures before the day of `when`; None if unknown.

        Where its stability is `stated`, they say it only if that is more than the largest of what is stated: a
        statement may know of what no check has met, and no check makes it smaller. One that nothing changes stands.

        Checks of one day show one state of the rig, so that the last of each day counts, and failed ones too. It takes
        as many days as the limits of the chart take values. One factor for all changes is small where a single one is
        large: it is no less than what the errors of the charted step are, against those by default, and more as few
        days leave their RMS unsure (Student's t). It is less than 1 from `QUIET_DAYS` on. Checks do not speak for a
        time further from the last of them than they are from each other, nor for a rig whose fan was once not found
        again.
        """
        about = 1.0 if stated is None else float(stated.over_default.max())
        if not about:
            return None
        before = [one for one in self.of_calibration(calibration_id) if not one.artefact and one.taken_at < when - _DAY]
        if any(math.isnan(one.error_mm) for one in before):
            return None
        of_days = {one.taken_at.date(): one for one in before if one.likelihoods is not None and one.by_default_mm > 0}
        if len(of_days) < FEWEST:
            return None
        taken = [one.taken_at for one in of_days.values()]
        apart = max(later - earlier for earlier, later in pairwise(taken))
        if when - taken[-1] > max(apart, 2 * _DAY):
            return None
        likely = most_likely_factor(np.array([one.likelihoods for one in of_days.values()]), about)
        shown = math.sqrt(sum((one.error_mm / one.by_default_mm) ** 2 for one in of_days.values()) / len(of_days))
        shown *= coverage_factor(len(of_days)) / coverage_factor(math.inf)  # few days tell their RMS badly
        factor = max(likely, shown)
        if stated is not None and factor < GIVES_WAY * about:
            return None
        if factor < 1 and stated is None and len(of_days) < QUIET_DAYS:
            return None
        return RigSpread(factor, len(of_days), taken[0], taken[-1])

    def beyond(self, check: PastCheck) -> Message | None:
        """Complain that a check's error lies outside its control limits; None if within, or if there is no error.

        An artefact is held to limits of its own history alone: its certificate is what E_n is for.
        """
        chart = self.chart(check)
        if math.isnan(check.error_mm) or chart.contains(check.error_mm) or (check.artefact and not chart.own):
            return None
        values = {"step_mm": check.step_mm, "error_mm": check.error_mm, "lower": chart.lower, "upper": chart.upper}
        if check.artefact:
            return Message(
                "artefact.beyond_history",
                "{id} is measured to {error_mm:+.3f} mm, outside {lower:+.3f} … {upper:+.3f} mm, where the {n} "
                "measurements before had it: look for what changed.",
                id=check.artefact,
                n=chart.n,
                **values,
            )
        if chart.own:
            return Message(
                "check.beyond_history",
                "A step of {step_mm:g} mm is off by {error_mm:+.3f} mm, outside {lower:+.3f} … {upper:+.3f} mm, where "
                "the {n} checks before had it: look for what changed.",
                n=chart.n,
                **values,
            )
        return Message(
            "check.beyond_stated",
            "A step of {step_mm:g} mm is off by {error_mm:+.3f} mm, outside {lower:+.3f} … {upper:+.3f} mm, which the "
            "rig's stability as stated or assumed allows: look for what changed.",
            **values,
        )

    def added(self, check: PastCheck) -> RigHistory:
        """Return the history with `check` added, in place of an earlier one of the same pictures and object."""
        others = (one for one in self.checks if one.looked_at != check.looked_at)
        return RigHistory(self.name, tuple(sorted((*others, check), key=lambda one: one.taken_at)))


class _HistoryFile(ResultFile):
    rig: str
    checks: tuple[PastCheck, ...]


def own_folder() -> Path:
    """Return the user's folder for the program's data, or that which the environment variable DATA names."""
    return Path(os.environ.get(DATA) or platformdirs.user_data_path("trisect", appauthor=False))


def history_file(name: str) -> Path:
    """Return the path of the file with the history of the rig called `name`, there or not."""
    return own_folder() / "rigs" / f"{name}.json"


def read_history(name: str) -> RigHistory:
    """Read the history of checks of the rig called `name`; empty if it has none, InputError if it is damaged."""
    path = history_file(name)
    if not path.exists():
        return RigHistory(name)
    file = checked_json(_HistoryFile, read_json(path, todo=_TODO), path)
    return RigHistory(file.rig, file.checks)


def store_check(name: str, check: PastCheck) -> RigHistory:
    """Add a check to the history of the rig called `name` and write it; returns the history, InputError if it fails.

    Raises
    ------
    InputError
        If the history is damaged, or cannot be written.
    """
    history = read_history(name).added(check)
    path = history_file(name)
    make_folder(path.parent)
    write_json(path, {"rig": name, "checks": [one.values for one in history.checks]})
    return history
