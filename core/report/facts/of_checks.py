"""What is told of an interim check, of a re-adjustment, and of a known artefact that was measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Protocol

from core.calibrate.results import ProposedReadjustment
from core.checks.artefact_check import KINDS, ArtefactCheck
from core.checks.control_chart import ControlChart
from core.messages import Message, decimals_of, label, plain, plural_message
from core.report.facts.fact import Fact, Grade, Reader, Value, named
from core.report.facts.pictures import Picture, used_fact
from core.report.facts.table import Cell, Column, FactTable, Uncertain
from core.states import CHECKS, VERDICT

GRADES: dict[str, Grade] = {"passed": "good", "doubtful": "warn", "failed": "bad"}
PROBABILITY = label("Probability that noise and the calibrations' uncertainty alone would set the stripes as far off")
STRIPES_OFF, STRIPES_OFF_MM = label("stripes off by"), label("stripes off on the target by")
CHANCE = label("chance")
ALLOWED_FROM, ALLOWED_TO = label("allowed from"), label("allowed to")


class Check(Protocol):
    """Interim check, as `core.files.results.check_file.InterimCheck`."""

    @property
    def calibration_id(self) -> str: ...
    @property
    def taken_at(self) -> datetime: ...
    @property
    def p(self) -> float: ...
    @property
    def poses(self) -> Sequence[Picture]: ...
    @property
    def step_mm(self) -> float: ...
    @property
    def error_mm(self) -> float: ...
    @property
    def unseen_mm(self) -> float: ...
    @property
    def offset_px(self) -> float: ...
    @property
    def offset_mm(self) -> float: ...
    @property
    def sentence(self) -> Message: ...


def check_facts(check: Check, chart: ControlChart | None = None) -> tuple[Fact, ...]:
    """Make the facts on an interim check: how far off camera and laser are; `chart` has the rig's control limits."""
    facts = [
        used_fact(label("pictures"), check.poses, label("Pictures that say something, and all there are")),
        Fact(
            Message("told.step_off", "step of {step_mm:g} mm off by", step_mm=check.step_mm),
            _known(check.error_mm), "mm", 3,
            label("How much too high it would be measured now; not corrected. ± could have been overlooked (k = 2)"),
            Reader.AUDITOR, U=_known(check.unseen_mm), signed=True,
        ),
        *(_allowed(check, chart) if chart is not None else ()),
        Fact(
            STRIPES_OFF, _known(check.offset_px), "px", 3,
            label("RMS distance from where the calibrations have them"), Reader.AUDITOR,
        ),
        Fact(
            STRIPES_OFF_MM, _known(check.offset_mm), "mm", 3, label("The same in mm"), Reader.METROLOGIST,
        ),
        Fact(CHANCE, check.p, tip=PROBABILITY, level=Reader.AUDITOR, significant=2),
        Fact(
            label("pictures taken"), Message("told.time", "{at}", at=check.taken_at.astimezone()),
            tip=label("The newest of them"), level=Reader.AUDITOR,
        ),
    ]  # fmt: skip
    return tuple(facts)


class PastCheck(Protocol):
    """Check of a rig's history, as `core.files.results.rig_history.PastCheck`."""

    @property
    def taken_at(self) -> datetime: ...
    @property
    def verdict(self) -> str: ...
    @property
    def p(self) -> float: ...
    @property
    def step_mm(self) -> float: ...
    @property
    def error_mm(self) -> float: ...
    @property
    def unseen_mm(self) -> float: ...
    @property
    def offset_px(self) -> float: ...
    @property
    def offset_mm(self) -> float: ...
    @property
    def celsius(self) -> float | None: ...
    @property
    def artefact(self) -> str: ...
    @property
    def e_n(self) -> float: ...


def history_fact(rig: str, checks: int) -> Fact:
    """Make the fact on how many checks the history of the rig called `rig` holds."""
    of = plural_message("told.rig", "{name}: {n:,} check", "{name}: {n:,} checks", n=checks, name=rig)
    never = Message("told.never_checked", "{name}: never checked on this computer", name=rig)
    return Fact(label("rig"), of if checks else never)


def history_table(checks: Iterable[tuple[PastCheck, ControlChart]]) -> FactTable:
    """Make the table of a rig's past checks, each with the limits of its control chart.

    A row has the result, and by how much a step was off.
    """
    columns = (
        Column(label("pictures taken")),
        Column(VERDICT),
        Column(label("artefact")),
        Column("E_n", digits=2),
        Column(STRIPES_OFF, "px", 3, level=Reader.AUDITOR),
        Column(STRIPES_OFF_MM, "mm", 3, level=Reader.METROLOGIST),
        Column(CHANCE, significant=2, level=Reader.AUDITOR),
        Column(label("step height"), "mm"),
        Column(label("off by"), "mm", signed=True),
        Column(ALLOWED_FROM, "mm", signed=True),
        Column(ALLOWED_TO, "mm", signed=True),
        Column(label("allowed by")),
        Column(label("air"), "°C"),
    )
    return FactTable(columns, tuple(_past_cells(one, chart) for one, chart in checks))


def _past_cells(check: PastCheck, chart: ControlChart) -> tuple[Cell, ...]:
    seen = (check.offset_px, check.offset_mm, check.p)
    allowed: Value = label("its uncertainty") if check.artefact else label("its stability")
    if chart.own:
        allowed = Message("told.by_history", "{n} checks before", n=chart.n)
    return (
        Message("told.time", "{at}", at=check.taken_at.astimezone()),
        CHECKS[check.verdict],
        plain(check.artefact) if check.artefact else None,
        check.e_n if check.artefact else None,
        *(None if check.artefact else _known(value) for value in seen),
        check.step_mm,
        *(Uncertain(mm, check.unseen_mm) if math.isfinite(mm) else None for mm in (check.error_mm, *chart.limits)),
        allowed,
        check.celsius,
    )


def _allowed(check: Check, chart: ControlChart) -> tuple[Fact, ...]:
    """Where a step's error is to lie by the rig's history, or by what is stated or assumed of it."""
    tip: Message | str = label(
        "Three standard uncertainties of what is stated or assumed of the rig's stability; after eight checks their "
        "own scatter takes its place"
    )
    if chart.own:
        tip = Message(
            "told.tip_charted",
            "Mean ± 3 standard deviations of the {n} checks before with these calibrations",
            n=chart.n,
        )
    grade: Grade = "" if math.isnan(check.error_mm) or chart.contains(check.error_mm) else "warn"
    return tuple(
        Fact(name, mm, "mm", decimals_of(check.unseen_mm), tip, Reader.AUDITOR, signed=True, grade=grade)
        for name, mm in zip((ALLOWED_FROM, ALLOWED_TO), chart.limits, strict=True)
    )


def readjustment_facts(done: ProposedReadjustment) -> tuple[Fact, ...]:
    """Make the facts on a re-adjustment of camera and fan: the changes, how certain they are, and their effect."""
    record = done.record
    was_chance = Message("told.was_chance", "{what}; before: {p:.2g}", what=PROBABILITY, p=record.p_before)
    return (
        Fact(label("poses"), record.poses, tip=label("Pictures that say something"), level=Reader.AUDITOR),
        *named(STRIPES_OFF, _before_and_after(done.offset_px, "px", Reader.TECHNICIAN)),
        *named(STRIPES_OFF_MM, _before_and_after(done.offset_mm, "mm", Reader.AUDITOR)),
        Fact(
            Message("told.step_larger", "step of {step_mm:g} mm larger by", step_mm=done.step_mm),
            done.correction_mm, "mm", 3, label("± is what camera and fan leave uncertain of it (k = 2)"),
            U=2 * done.u_mm, signed=True,
        ),
        Fact(CHANCE, record.p_after, tip=was_chance, level=Reader.AUDITOR, significant=2),
        *_changes(done),
    )  # fmt: skip


def _before_and_after(lengths: tuple[float, float], unit: str, level: Reader) -> tuple[Fact, Fact]:
    before, after = lengths
    return Fact(label("before"), before, unit, 3, level=level), Fact(label("after"), after, unit, 3, level=level)


def _changes(done: ProposedReadjustment) -> tuple[Fact, ...]:
    """Each part of the change with its standard uncertainty."""
    x, y, z = (label("about x"), label("about y"), label("about z"))
    along = (label("along x"), label("along y"), label("along z"))
    turned, moved, drifted = label("fan turned"), label("fan moved"), label("picture moved")
    parts = [
        *((turned, axis, 1e6, "µrad") for axis in (x, y, z)),
        *((moved, axis, 1e3, "µm") for axis in along),
        *((drifted, axis, 1.0, "px") for axis in along[:2]),
        (label("focal length"), label("as a share"), 1e6, "·10⁻⁶"),
    ]
    about = label("u is the standard uncertainty (k = 1)")
    return tuple(
        Fact(
            Message("told.named", "{of}, {name}", of=of, name=axis), by * float(change), unit,
            decimals_of(by * float(sd)), about, Reader.AUDITOR, sd=by * float(sd), signed=True,
        )
        for (of, axis, by, unit), change, sd in zip(parts, done.record.change, done.record.sd, strict=True)
    )  # fmt: skip


def artefact_facts(check: ArtefactCheck) -> tuple[Fact, ...]:
    """Make the facts on a measured artefact: its length, its certificate, and how far the two agree."""
    known, U = check.artefact, 2 * check.u_mm
    due = label("not stated") if known.due is None else known.due.isoformat()
    return (
        Fact(VERDICT, CHECKS[check.verdict], tip=check.sentence, grade=GRADES[check.verdict]),
        Fact(
            label("error"), check.error_mm, "mm", decimals_of(2 * check.u_error_mm),
            label("Measured − certified. ± is U (k = 2) of both together: a smaller error is not detected"),
            U=2 * check.u_error_mm, signed=True,
        ),
        Fact(
            label("measured"), check.measured_mm, "mm", decimals_of(U),
            Message("told.tip_compared", "{what}; ± is U (k = 2)", what=check.characteristic or KINDS[known.kind]),
            U=U,
        ),
        Fact(
            label("certified"), known.value_mm, "mm", decimals_of(known.U_mm),
            Message("told.tip_certified", "By its certificate; ± is U (k = {k:g})", k=known.k), Reader.AUDITOR,
            U=known.U_mm,
        ),
        Fact("E_n", check.e_n, digits=2, tip=label("Error over the U of both together"), level=Reader.AUDITOR),
        Fact(label("certificate"), known.certificate or label("not stated"), level=Reader.AUDITOR),
        Fact(label("valid until"), due, level=Reader.AUDITOR, grade="warn" if check.lapsed else ""),
        Fact(label("measured on"), check.day.isoformat(), level=Reader.AUDITOR),
    )  # fmt: skip


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
