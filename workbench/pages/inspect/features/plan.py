"""Features measured beside the thickness: the plan is edited here, every edit undoable, and measured as a whole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from PySide6.QtCore import QObject, Signal

from core.errors import InputError
from core.files.project.keys import finished, up_to_date
from core.inspect.plan.control_frame import datum_letters, datums_of
from core.inspect.plan.feature_spec import FeatureSpec, PointsOf
from core.inspect.plan.inspection_plan import InspectionPlan
from workbench.bench import Bench
from workbench.language import joined, text_of, tr
from workbench.pages.inspect.features import words
from workbench.pages.inspect.scan import InspectScan
from workbench.work import jobs
from workbench.work.tasks import Task

if TYPE_CHECKING:
    from core.inspect.shown.shown_features import ShownFeature, ShownInspection
    from core.model import Pose


@dataclass(frozen=True, slots=True)
class FeaturesFacts:
    """Facts from which the buttons follow."""

    no_scan: str
    """Why there is no scan to be measured."""
    cannot_write: str
    """Why nothing can be measured into the project."""
    measured: bool
    """There is a result: of a plan that was emptied since it goes by measuring."""
    measuring: bool
    count: int
    """How many features there are."""
    place: int
    """Of the chosen one, from 0; −1: none is."""
    cannot_remove: str
    """Why the chosen one cannot be taken out: what rests on it."""


class FeaturesButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    measure: str
    remove: str
    up: str
    down: str
    save: str
    """Save the plan as a template."""


def features_buttons(facts: FeaturesFacts) -> FeaturesButtons:
    """Derive why each button of the list of features is disabled; "" for each that is enabled."""
    none = "" if facts.count else tr("Add a feature first.")
    choose = "" if facts.place >= 0 else tr("Choose a feature first.")
    return FeaturesButtons(
        measure=facts.no_scan
        or facts.cannot_write
        or ("" if facts.measured else none)
        or (tr("The features are being measured.") if facts.measuring else ""),
        remove=choose or facts.cannot_remove,
        up=choose or ("" if facts.place else tr("It is the first.")),
        down=choose or ("" if facts.place < facts.count - 1 else tr("It is the last.")),
        save=none,
    )


NO_OTHERS: Mapping[str, str] = MappingProxyType({})
THICKNESS = "#thickness"
"""What the gauge's thickness is called among the features, where it is chosen or has its callout."""

REMEMBERING = {"progress": "progress", "memory": "memory"}
"""What is offered to the jobs here: features that an edit leaves as they are need not be measured again."""


class InspectFeatures(QObject):
    """Plan of the project, its results on this scan, and the chosen feature."""

    changed = Signal()

    def __init__(self, bench: Bench, scan: InspectScan) -> None:
        super().__init__()
        self.bench, self.model, self._scan = bench, bench.model, scan
        self._measuring: Task | None = None
        self._shown: ShownInspection | None = None
        self._shown_for: tuple[InspectionPlan, object] | None = None
        self.problem = ""
        self.chosen = ""

    @property
    def callouts_moved(self) -> Mapping[str, tuple[float, float]]:
        """Distance (right, down) in px by which each callout was dragged, by its feature's name."""
        return self.model.project.callouts

    # ---- the plan

    @property
    def plan(self) -> InspectionPlan:
        """Inspection plan of the project."""
        return self.model.project.inspection

    def free_name(self, kind: str, taken: Sequence[str] = ()) -> str:
        """Make a name for a new feature of a kind, "plane 2", that no feature has and that is not in `taken`."""
        return self._numbered(words.usual_name(kind), 1, taken)

    def _numbered(self, name: str, number: int, taken: Sequence[str] = ()) -> str:
        """The name with the first number from this one on that no feature has with it."""
        while f"{name} {number}" in (*self.plan.names, *taken):
            number += 1
        return f"{name} {number}"

    def complaint(self, spec: FeatureSpec, instead_of: str = "") -> str:
        """Return a sentence on why the plan would be wrong with the feature `spec`; "" if it would not be."""
        try:
            self._with(spec, instead_of).ordered()
        except InputError as error:
            return text_of(error)
        return ""

    def put(self, spec: FeatureSpec, instead_of: str = "") -> None:
        """Add a feature to the plan, or replace the one called `instead_of`; undoable."""
        plan = self._with(spec, instead_of)
        label = tr("change {name}", name=spec.name) if instead_of else tr("add {name}", name=spec.name)
        self.chosen = spec.name
        self.put_plan(plan, label, {instead_of: spec.name})

    def add(self, specs: Sequence[FeatureSpec]) -> None:
        """Add features, of which the last is made of the others, and choose the last; one edit, undoable."""
        self.chosen = specs[-1].name
        plan = replace(self.plan, features=(*self.plan.features, *specs))
        self.put_plan(plan, tr("add {name}", name=self.chosen))

    def duplicate(self, name: str) -> None:
        """Insert a copy of the feature called `name` below it, and choose the copy; undoable."""
        if name not in self.plan.names:
            return
        spec, place = self.plan.feature(name), self.plan.names.index(name) + 1
        stem, _, number = name.rpartition(" ")
        copy = replace(spec, name=self._numbered(stem if stem and number.isdigit() else name, 2))
        self.chosen = copy.name
        features = (*self.plan.features[:place], copy, *self.plan.features[place:])
        self.put_plan(replace(self.plan, features=features), tr("duplicate {name}", name=name))

    def remove(self, name: str) -> None:
        """Remove the feature called `name` from the plan, unless others depend on it; undoable."""
        why_not = self.cannot_remove(name)
        if why_not:
            self.bench.notices.warning(why_not)
            return
        kept = tuple(one for one in self.plan.features if one.name != name)
        master = self.plan.master
        if master is not None:
            master = replace(master, features=tuple(one for one in master.features if one != name))
        self.put_plan(replace(self.plan, features=kept, master=master), tr("remove {name}", name=name))

    def cannot_remove(self, name: str) -> str:
        """Return a sentence on which features depend on the feature called `name`; "" if none does."""
        frame = self.plan.frame.names if self.plan.frame is not None else ()
        resting = [one.name for one in self.plan.features if name in one.needs]
        if name in frame:
            resting.append(tr("the part's coordinates"))
        if self.plan.master is not None and self.plan.master.features == (name,):
            resting.append(tr("the comparison with the master"))
        if resting:
            return tr("{name} cannot be removed: {others} rests on it.", name=name, others=joined(resting))
        return ""

    def move(self, name: str, by: int) -> None:
        """Move the feature called `name` up (−1) or down (+1) in the list; undoable."""
        names = list(self.plan.names)
        if name not in names or not 0 <= names.index(name) + by < len(names):
            return
        features = list(self.plan.features)
        features.insert(names.index(name) + by, features.pop(names.index(name)))
        self.put_plan(replace(self.plan, features=tuple(features)), tr("move {name}", name=name))

    def put_plan(self, plan: InspectionPlan, label: str, renamed: Mapping[str, str] = NO_OTHERS) -> None:
        """Replace the project's plan, under the edit's name `label`; undoable. Callouts stay at their places."""
        moved = {renamed.get(name, name): to for name, to in self.callouts_moved.items()}
        callouts = {name: to for name, to in moved.items() if name in plan.names or name not in self.plan.names}
        self.model.edit(label, replace(self.model.project, inspection=plan, callouts=callouts))
        if self.chosen not in (*plan.names, THICKNESS):
            self.chosen = ""

    # ---- measuring

    @property
    def measuring(self) -> bool:
        """Whether the plan is being measured."""
        return self._measuring is not None

    @property
    def buttons(self) -> FeaturesButtons:
        """Reason why each button of the list is disabled for the chosen feature; "" if it is enabled."""
        names = self.plan.names
        return features_buttons(
            FeaturesFacts(
                no_scan=self._scan.buttons.measure,
                cannot_write=self.bench.cannot_write,
                measured="inspection" in self.model.results,
                measuring=self.measuring,
                count=len(names),
                place=names.index(self.chosen) if self.chosen in names else -1,
                cannot_remove=self.cannot_remove(self.chosen),
            )
        )

    @property
    def up_to_date(self) -> bool:
        """Whether the results shown are of the present plan and the present scan."""
        return up_to_date("inspection", self.model.project, self.model.results)

    def measure(self) -> None:
        """Measure the whole plan on the scan in the project's results, in the background."""
        model, project, folder = self.model, self.model.project, self.model.folder
        if folder is None or self.buttons.measure:
            return
        self.problem, wanted, results = "", self._wanted(), model.results

        def done(shown: Any) -> None:
            if folder == model.folder:
                self._shown, self._shown_for = shown, wanted
                model.record("inspection", finished("inspection", project, results))

        self._run(jobs.MEASURE_FEATURES, folder, done, tr("Measuring the features"))

    def measure_first(self) -> None:
        """Measure the plan if it was never measured; after that, each edit is measured automatically."""
        if "inspection" not in self.model.results:
            self.measure()

    def follow(self, before: InspectionPlan) -> None:
        """Show the results of the edited plan, and measure it again if the plan `before` was measured."""
        if self.plan == before:
            return
        self.problem = ""
        if self.chosen not in (*self.plan.names, THICKNESS):
            self.chosen = ""
        self._measure_again()

    def look(self) -> None:
        """Read the project's results of the plan, if they are of the present plan and scan."""
        folder = self.model.folder
        if folder is None or self.measuring or not self.up_to_date or self.shown is not None:
            return
        wanted = self._wanted()

        def done(shown: Any) -> None:
            if folder == self.model.folder:
                self._shown, self._shown_for = shown, wanted

        self._run(jobs.LOOK_AT_FEATURES, folder, done, tr("Preparing the features"))

    @property
    def shown(self) -> ShownInspection | None:
        """Results of the plan, as they are drawn; None if they are not of the present plan and scan."""
        return self._shown if self._shown_for == self._wanted() else None

    @property
    def pose_camera_part(self) -> Pose | None:
        """Pose of the part coordinates in the camera frame; None if it is not known for this plan."""
        frame = self.plan.frame
        if frame is None or self._shown is None or self._shown_for is None or self._shown_for[0].frame != frame:
            return None
        return None if any(self.result(name) is None for name in frame.names) else self._shown.pose_camera_part

    def result(self, name: str) -> ShownFeature | None:
        """Return the result of the feature called `name`; None if it is not measured or out of date."""
        found = self._earlier(name)
        if found is None or self._shown_for is None:
            return None
        return found if self._shown_for[0].asks_the_same(name, self.plan) else None

    def outdated(self, name: str) -> ShownFeature | None:
        """Return the result that the feature called `name` had before an edit; None if it is up to date or has none."""
        found = self._earlier(name)
        if found is None or name not in self.plan.names or found.kind != self.plan.feature(name).kind:
            return None
        return None if self.result(name) is found else found

    def rests_on(self, name: str) -> tuple[list[ShownFeature], dict[str, list[ShownFeature]]]:
        """List the features whose points the feature called `name` uses, and its datums by their letters.

        A part that is made of others itself stands for theirs. What is not measured is left out.
        """
        if name not in self.plan.names:
            return [], {}
        spec, letters = self.plan.feature(name), datum_letters(self.plan)
        datums = datums_of(spec, self.plan)
        parts = [one for part in spec.of if part not in datums for one in self._measured(part)]
        by_letter = {letters[one]: self._measured(one) for one in datums if one in letters}
        return [*self._measured(name)] if not spec.of else parts, by_letter

    def _measured(self, name: str) -> list[ShownFeature]:
        """The result of a feature that has points, or those of what it is made of."""
        spec = self.plan.feature(name) if name in self.plan.names else None
        if spec is None:
            return []
        found = [self.result(name)] if not spec.of else [one for part in spec.of for one in self._measured(part)]
        return [one for one in found if one is not None]

    def choose(self, name: str) -> None:
        """Choose the feature called `name` and show its points; "" chooses none."""
        if name != self.chosen:
            self.chosen = name
            self.changed.emit()

    def move_callout(self, name: str, moved: tuple[float, float] | None) -> None:
        """Store by how many px (right, down) a feature's callout was dragged; None resets it. Undoable."""
        callouts = {other: to for other, to in self.callouts_moved.items() if other != name}
        if moved is not None:
            callouts[name] = moved
        self.model.edit(tr("move the plate of a result"), replace(self.model.project, callouts=callouts))

    def forget(self) -> None:
        """Drop all results of features, as another project is open."""
        self._shown, self._shown_for = None, None
        self.problem = self.chosen = ""

    # ---- inside

    def _run(self, job: jobs.Job, folder: Path, done: Any, label: str) -> None:
        def failed(problem: Any) -> None:
            if folder == self.model.folder:
                self.problem = text_of(problem)

        self._measuring = self.bench.run_long(
            self, job, folder, self.model.project, label=label, on_done=done, on_failed=failed, offers=REMEMBERING
        )
        self._measuring.ended.connect(self._ended)
        self.changed.emit()

    def _ended(self) -> None:
        self._measuring = None
        self._measure_again()
        self.changed.emit()

    def _measure_again(self) -> None:
        """Measure a plan that has changed since it was measured; one that failed waits for the next edit."""
        if "inspection" in self.model.results and not self.up_to_date and not self.problem:
            self.measure()

    def _wanted(self) -> tuple[InspectionPlan, object]:
        scan = self.model.results.get("scan")
        return self.plan, None if scan is None else scan.key

    def _earlier(self, name: str) -> ShownFeature | None:
        """What a feature gave when this scan's features were measured the last time."""
        if self._shown is None or self._shown_for is None or self._shown_for[1] != self._wanted()[1]:
            return None
        return next((one for one in self._shown.features if one.name == name), None)

    def _with(self, spec: FeatureSpec, instead_of: str) -> InspectionPlan:
        if not instead_of:
            return replace(self.plan, features=(*self.plan.features, spec))
        renamed = tuple(
            spec if one.name == instead_of else _following(one, instead_of, spec.name) for one in self.plan.features
        )
        frame = self.plan.frame
        if frame is not None:
            names = {key: getattr(frame, key) for key in ("primary", "secondary", "tertiary")}
            frame = replace(frame, **{key: spec.name if name == instead_of else name for key, name in names.items()})
        master = self.plan.master
        if master is not None:
            compared = tuple(spec.name if name == instead_of else name for name in master.features)
            master = replace(master, features=compared)
        return replace(self.plan, features=renamed, frame=frame, master=master)


def _following(spec: FeatureSpec, before: str, now: str) -> FeatureSpec:
    """A feature that rests on another one which has a new name."""
    regions: Sequence[Any] = [
        PointsOf(now) if isinstance(region, PointsOf) and region.feature == before else region
        for region in spec.regions
    ]
    return replace(spec, of=tuple(now if name == before else name for name in spec.of), regions=tuple(regions))
