"""Faces clicked in 3D: each grows from the click and is shown; Enter takes what is shown into the plan."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from PySide6.QtCore import QObject, Signal

from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.kinds import kind_of
from core.report.wording import grouped
from workbench.language import joined, number, tr
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features.plan import REMEMBERING, InspectFeatures
from workbench.pages.inspect.scan import InspectScan
from workbench.work import jobs
from workbench.work.tasks import Task

if TYPE_CHECKING:
    from core.inspect.shown.clicked_faces import ClickedFace, ClickedFaces

Mode = Literal["", "face", "step"]

STEP = "thickness"
"""The kind of feature that measures between two parallel faces."""


class Target(NamedTuple):
    """Region that a clicked face replaces: of a feature, at a place."""

    feature: str
    place: int


class InspectClicked(QObject):
    """Builder of features from clicks in 3D: nothing is an edit before `take`, and that is one."""

    changed = Signal()

    def __init__(self, features: InspectFeatures, scan: InspectScan) -> None:
        super().__init__()
        self._features, self._scan = features, scan
        self.mode: Mode = ""
        self.proposal: ClickedFaces | None = None
        self._target: Target | None = None
        self._points: tuple[int, ...] = ()
        self._growing: Task | None = None
        self._chosen = ""
        features.changed.connect(self.follow)

    def start(self, mode: Mode, target: Target | None = None) -> None:
        """Start proposing a face by one click in 3D, or a step by two; the mode "" ends it.

        A face is for the region `target`, or else for that of the chosen feature if it has just one, or for a new
        feature.
        """
        self.mode, self._target = mode, target or self._region_of(self._features.chosen)
        self._chosen = self._features.chosen
        self._drop()

    def stop(self) -> None:
        """End proposing by clicks, and drop the proposal."""
        if self.mode:
            self.start("")

    def click(self, point: int) -> None:
        """Grow a face from the clicked point, in place of the last proposal."""
        view, folder = self._scan.view, self._features.model.folder
        if view is None or folder is None or not self.mode or not 0 <= point < len(view):
            return
        first = self._points[:1] if self.mode == "step" and self.proposal is not None else ()
        points = (*first, int(view.number[point]))
        if points[-1:] == self._points[-1:]:
            return  # a double click
        self._points = points

        def done(proposal: Any) -> None:
            if task is self._growing:
                self.proposal = proposal

        def failed(_: Any) -> None:
            if task is self._growing:
                self._points = first

        def ended() -> None:
            if task is self._growing:
                self._growing = None
                self.changed.emit()

        self._growing = task = self._features.bench.run_quick(
            self,
            jobs.CLICKED_FACES,
            folder,
            points,
            self._asked,
            self._features.pose_camera_part,
            label=tr("Growing the face"),
            on_done=done,
            on_failed=failed,
            offers=REMEMBERING,
            replace_waiting=True,
        )
        task.ended.connect(ended)
        self.changed.emit()

    def take(self) -> None:
        """Add the proposed face or step to the plan and measure it; one edit, undoable."""
        proposal = self.proposal
        if proposal is None or self._growing is not None or (self.mode == "step" and len(proposal.faces) < 2):
            return
        if self.mode == "face":
            self._take_face(proposal.faces[0])
        else:
            self._take_step(proposal)
        self._drop()
        self._features.measure_first()

    def hint(self) -> str:
        """Write what is proposed, and what a click and Enter do next."""
        if self._growing is not None:
            return tr("Growing the face …")
        faces = () if self.proposal is None else self.proposal.faces
        if not faces:
            click = tr("Click a face.") if self.mode == "face" else tr("Click the first of two faces.")
            return click + " " + tr("Drag turns the view, Esc ends.")
        shown = joined(map(_said, faces), ";")
        if self.mode == "step" and len(faces) < 2:
            return shown + "\n" + tr("Click the second face. Esc ends.")
        return shown + "\n" + self._what_enter_does() + " " + tr("Click elsewhere for another, Esc drops it.")

    def follow(self) -> None:
        """Propose faces for the feature that is chosen now, or keep to the feature before under its new name."""
        features = self._features
        if not self.mode or features.chosen == self._chosen:
            return
        if not self._chosen or self._chosen in features.plan.names:
            self.start(self.mode)
            return
        self._chosen = features.chosen
        if self._target is not None:
            self._target = self._region_of(features.chosen)
            self.changed.emit()

    # ---- inside

    @property
    def _asked(self) -> str:
        """What the face must be, for the region that it is for; "" for whatever it is."""
        if self.mode == "step" or self._target is None:
            return ""
        kind = kind_of(self._features.plan.feature(self._target.feature))
        return {"numbered": "plane", "searched": kind.name}.get(kind.automatic, "")

    def _what_enter_does(self) -> str:
        assert self.proposal is not None
        if self.mode == "step":
            if self.proposal.parallel:
                return tr("Enter measures the step between them.")
            if self._planes:
                return tr("They are not parallel: Enter measures the angle between them.")
            return tr("Enter measures the distance between them.")
        if self._target is not None:
            return tr("Enter takes it for {name}.", name=self._target.feature)
        return tr("Enter adds it as a feature.")

    @property
    def _planes(self) -> bool:
        return self.proposal is not None and all(face.kind == "plane" for face in self.proposal.faces)

    def _region_of(self, name: str) -> Target | None:
        """The region of a feature that has just one, and of no kind that goes between faces."""
        plan = self._features.plan
        if name not in plan.names:
            return None
        spec = plan.feature(name)
        one = len(fields.own_regions(spec)) == 1 and kind_of(spec).most_regions == 1
        return Target(name, 0) if one else None

    def _take_face(self, face: ClickedFace) -> None:
        features, target = self._features, self._target
        if target is None:
            self._put(self._new(face))
            return
        spec = features.plan.feature(target.feature)
        made = [fields.with_region(spec, target.place, seed) for seed in face.seeds]
        self._put(self._possible(made, spec.name), spec.name)

    def _take_step(self, proposal: ClickedFaces) -> None:
        features, (first, second) = self._features, proposal.faces
        if proposal.parallel:
            name = features.free_name(STEP)
            pairs = zip(first.seeds, second.seeds, strict=True)
            self._put(self._possible([FeatureSpec(name, STEP, pair) for pair in pairs], ""))
            return
        made = [self._new(first)]
        made.append(self._new(second, (made[0].name,)))
        kind = "angle" if self._planes else "distance"
        between = FeatureSpec(features.free_name(kind), kind, of=(made[0].name, made[1].name))
        self._chosen = between.name
        features.add((*made, between))

    def _new(self, face: ClickedFace, taken: tuple[str, ...] = ()) -> FeatureSpec:
        """A feature of a face, by a name that none of the plan and of those `taken` has."""
        name = self._features.free_name(face.kind, taken)
        return self._possible([FeatureSpec(name, face.kind, (seed,)) for seed in face.seeds], "")

    def _possible(self, made: list[FeatureSpec], instead_of: str) -> FeatureSpec:
        """The first with which the plan is right: what part coordinates rest on cannot be placed in them."""
        return next((spec for spec in made if not self._features.complaint(spec, instead_of)), made[-1])

    def _put(self, spec: FeatureSpec, instead_of: str = "") -> None:
        self._chosen = spec.name  # its own choice: the next face is for another new feature
        self._features.put(spec, instead_of)

    def _drop(self) -> None:
        self.proposal, self._points, self._growing = None, (), None
        self.changed.emit()


def _said(face: ClickedFace) -> str:
    names = {"plane": tr("Plane"), "sphere": tr("Sphere"), "cylinder": tr("Cylinder")}
    return tr(
        "{surface}: {points} points, scatter {rms} mm",
        surface=names[face.kind],
        points=grouped(face.used),
        rms=number(face.rms_mm, ".3f"),
    )
