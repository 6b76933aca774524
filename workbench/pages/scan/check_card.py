"""The Check card: whether camera and laser are where they were calibrated, how far off, and what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication, QFrame, QLabel, QPushButton, QWidget

from core.calibrate.results import ProposedReadjustment
from core.checks.artefact_check import ArtefactCheck
from core.checks.control_chart import ControlChart
from core.files.results.check_file import InterimCheck
from core.files.results.rig_history import CheckChart, PastCheck, RigHistory
from core.messages import capital
from core.pipeline.live.events import Detail, PlanesDetail
from core.report.facts.fact import Fact, named
from core.report.facts.of_checks import GRADES, artefact_facts, check_facts, readjustment_facts
from core.report.facts.pictures import left_out
from core.states import CHECKS, OUT_OF_DATE, STEP_STATES, changed_since
from workbench.language import joined, number, sentence, sentences, text_of, time_of, tr
from workbench.pages.live.presenter import LivePresenter
from workbench.pages.scan.artefact_dialog import ArtefactDialog
from workbench.pages.scan.artefacts import KnownArtefacts
from workbench.pages.scan.check import CheckStage, RigCheck
from workbench.pages.scan.stage import CheckButtons, CheckFacts, check_buttons
from workbench.pages.words import fact_lines, show_facts
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.colours import Level
from workbench.views.common import Choice, IconLabel, dress
from workbench.views.forms.live_panel import ask_to_stop_other
from workbench.views.layouts import enable, heading, in_column, in_row, mark_primary, muted, rename, set_text
from workbench.views.lists.value_rows import LEVEL_ICONS, ValueRows
from workbench.views.plots.control import ControlPlot


class CheckCard(QFrame):
    """Card of the check: icon and word, a sentence on what to do, the figures, and the buttons."""

    def __init__(
        self, check: RigCheck, artefacts: KnownArtefacts, live: LivePresenter, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        self._check, self._artefacts, self._live, self._seen = check, artefacts, live, ""
        self._wanted = False
        self.sign, self.word, self.sentence, self.rows = IconLabel(18), QLabel(), muted(), ValueRows()
        self.word.setWordWrap(True)
        self.chart, self.charted = ControlPlot(), Choice()
        self.charted.setAccessibleName(tr("What the chart shows"))
        self.charted.activated.connect(self._choose_chart)
        self._wanted_chart = ""
        self.take, self.choose, self.run, self.readjust = QPushButton(), QPushButton(), QPushButton(), QPushButton()
        self.readjust.clicked.connect(check.propose_readjustment)
        self.compare = QPushButton(tr("Compare with an artefact …"))
        self.compare.clicked.connect(self._compare)
        check.proposed.connect(self._ask_to_readjust)
        self.choose.setAccessibleName(tr("Folder with the pictures of the check"))
        self.choose.setFixedWidth(36)  # three buttons fit side by side where the panel is narrow
        self.choose.setIcon(icon("mdi6.folder-open-outline"))
        self.take.clicked.connect(self._take)
        self.choose.clicked.connect(self._choose)
        self.run.clicked.connect(self._run)
        live.other_running.connect(self._ask_to_stop_other)
        live.sounded.connect(self._beep)
        light = in_row(self.sign, (self.word, 1), spacing=6)
        buttons = in_row((self.take, 1), self.choose, (self.run, 1), spacing=6)
        title = heading(tr("Check of camera and laser"))
        in_column(
            title, light, self.sentence, self.rows, self.charted, self.chart, self.readjust, buttons, self.compare,
            on=self, margins=(10, 8, 10, 10), spacing=5,
        )  # fmt: skip

    def _beep(self) -> None:
        QApplication.beep()

    def _ask_to_stop_other(self, question: str) -> None:
        ask_to_stop_other(self, self._live, question)

    def refresh(self, *, wanted: bool = False) -> None:
        """Show the state of the interim check; `wanted`: its pictures are the next thing to take."""
        self._wanted = wanted
        check, stage = self._check, self._check.stage
        taking = self._live.running
        level, word, sentence = self._taking() if taking else self._said(stage)
        symbol, colour = LEVEL_ICONS[level] if level else ("mdi6.help-circle-outline", "muted")
        self.sign.show_icon(symbol, colour)
        self.sign.setAccessibleName(word)
        self.word.setText(word)
        dress(self.word, f"color: {getattr(shades(), colour)}; font-weight: 600;")
        set_text(self.sentence, sentence)
        shown = check.look if stage in (CheckStage.CHECKED, CheckStage.OUTDATED) and not taking else None
        past = check.past if shown is not None else None
        limits = check.history.chart(past) if check.history is not None and past is not None else None
        told = facts(shown, limits, () if taking else self._artefacts.checks)
        show_facts(self.rows, told)
        self._show_chart({} if taking else self._charts(check.history, past))
        self.rows.setVisible(bool(told))
        checking = stage is CheckStage.CHECKING
        rename(self.take, tr("Stop") if taking else tr("Take 3 pictures"))
        can = self._buttons()
        primary = wanted and not can.take
        self.take.setIcon(icon("mdi6.stop" if taking else "mdi6.camera-iris", colour="on_accent" if primary else ""))
        mark_primary(self.take, primary)
        enable(
            self.take,
            can.take,
            tr("Check with the pictures taken so far")
            if taking
            else tr("Hold the plane target into the fan: up to three pictures are taken by themselves, then checked"),
        )
        enable(
            self.choose,
            can.choose,
            tr("Choose the folder with pictures of the plane target in the fan, taken today (now: {folder})",
               folder=check.folder or tr("none")),
        )  # fmt: skip
        rename(self.run, tr("Cancel") if checking else tr("Check again") if shown else tr("Check"))
        self.run.setIcon(icon("mdi6.stop" if checking else "mdi6.play"))
        tip = tr("Stop checking; the result before is kept") if checking else tr(
            "Compare the stripes in the pictures with where the calibrations have them"
        )  # fmt: skip
        enable(self.run, can.run, tip)
        self.compare.setIcon(icon("mdi6.ruler-square"))
        enable(
            self.compare,
            can.compare,
            tr("Compare what was measured with the certificate of the block, sphere or step that was scanned"),
        )
        self._refresh_readjust(can.readjust)

    def _buttons(self) -> CheckButtons:
        """What can be done now."""
        check, live = self._check, self._live
        facts = CheckFacts(
            taking=live.running,
            stopping=live.stopping,
            cannot_take=live.why_not_start,
            checking=check.stage is CheckStage.CHECKING,
            cannot_check=check.cannot_check,
            cannot_readjust=check.cannot_readjust,
            cannot_compare=self._artefacts.cannot_compare,
            moved=check.valid is not None and not check.valid.passed,
        )
        return check_buttons(facts)

    def _refresh_readjust(self, why_not: str | None) -> None:
        """The button is there where a check says that something has changed."""
        self.readjust.setText(tr("Re-adjust …"))
        self.readjust.setIcon(icon("mdi6.tune"))
        self.readjust.setVisible(why_not is not None)
        enable(
            self.readjust,
            why_not or "",
            tr("Work out by how much laser and camera would have to be moved to fit the check, and decide"),
        )

    def _ask_to_readjust(self, proposal: ProposedReadjustment) -> None:
        """Accepted, or left as it is."""
        text = f"{text_of(proposal.record.note)}\n\n{fact_lines(readjustment_facts(proposal))}"
        answers = [tr("Accept the re-adjustment"), tr("Reject")]
        if ask.ask(self, tr("Re-adjust camera and laser?"), text, answers) == 0:
            self._check.accept_readjustment(proposal)

    def show_detail(self, detail: Detail | None) -> None:
        """Show what the check says of the present live picture; None shows nothing."""
        sentence = detail.sentence if isinstance(detail, PlanesDetail) else None
        seen = text_of(sentence) if sentence is not None else ""
        if seen != self._seen:
            self._seen = seen
            self.refresh(wanted=self._wanted)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.refresh(wanted=self._wanted)

    def _taking(self) -> tuple[Level, str, str]:
        """Level, word and sentence while pictures are taken."""
        hold = tr(
            "Hold the plane target into the fan where the parts will be, each time tilted by about 40° to another side."
        )
        live = self._live
        return "", live.counts_text() or live.state_text(), f"{hold}\n{self._seen}" if self._seen else hold

    def _said(self, stage: CheckStage) -> tuple[Level, str, str]:
        """Level, word and sentence of a stage."""
        check = self._check
        match stage:
            case CheckStage.NONE:
                return "", tr("Not checked"), tr(
                    "One to three pictures of the plane target in the fan, taken today, show whether anything has "
                    "moved since the calibration."
                )  # fmt: skip
            case CheckStage.CHOSEN:
                return "", tr("Not checked yet"), check.cannot_check or tr("Press Check.")
            case CheckStage.CHECKING:
                return "", tr("Checking …"), tr("Cancel keeps the result before.")
            case CheckStage.UNREADABLE:
                return "bad", tr("Not checked"), check.problem
        assert check.look is not None
        if stage is CheckStage.OUTDATED:
            why = sentence(capital(text_of(changed_since(check.changed_since()))))
            return "warn", capital(tr(STEP_STATES["outdated"])), sentences(why, tr(OUT_OF_DATE["check"]))
        verdict, found = check.look.verdict, [check.look.sentence]
        outside = check.history.beyond(check.past) if check.history is not None and check.past is not None else None
        if outside is not None:
            found = [*(found if verdict != "passed" else []), outside]
            verdict = "failed" if verdict == "failed" else "doubtful"
        reasons = [text_of(one.line()) for one in left_out(check.look.poses)]
        if verdict == "passed":  # its sentence begins with the word
            return GRADES[verdict], text_of(check.look.sentence), "\n".join(filter(None, (check.refusal, *reasons)))
        said = sentences(*map(text_of, found), check.refusal)
        return GRADES[verdict], capital(tr(CHECKS[verdict])), "\n".join((said, *reasons))

    def _charts(self, history: RigHistory | None, past: PastCheck | None) -> Mapping[str, CheckChart]:
        """What there are two or more of with these calibrations, by its name: pictures, and each artefact."""
        of_pictures = (
            {tr("Pictures of the target"): history.charted(past)} if history is not None and past is not None else {}
        )
        charts = {**of_pictures, **{one.checks[-1].artefact: one for one in self._artefacts.charts}}
        return {name: one for name, one in charts.items() if len(one.checks) > 1}

    def _show_chart(self, charts: Mapping[str, CheckChart]) -> None:
        """One chart, each value scaled to the height of the last one's step; of several one can be chosen."""
        names = list(charts)
        if [self.charted.itemText(row) for row in range(self.charted.count())] != names:
            self.charted.clear()
            self.charted.addItems(names)
            self.charted.setCurrentIndex(max(0, self.charted.findText(self._wanted_chart)))
        self.charted.setVisible(len(names) > 1)
        self.chart.setVisible(bool(names))
        if not names:
            return
        checks, limits = charts[self.charted.currentText()]
        last = checks[-1]
        self.chart.set_values(
            [one.error_mm / one.step_mm * last.step_mm for one in checks],
            [one.verdict == "passed" for one in checks],
            [_tip(one) for one in checks],
            (limits.lower, limits.centre, limits.upper),
            axes=(tr("artefact off by") if last.artefact else tr("step off by"), tr("check")),
        )

    def _choose_chart(self) -> None:
        self._wanted_chart = self.charted.currentText()
        self.refresh(wanted=self._wanted)

    def _run(self) -> None:
        if self._check.stage is CheckStage.CHECKING:
            self._check.cancel()
        else:
            self._check.start()

    def _take(self) -> None:
        self._seen = ""
        self._live.toggle()

    def _compare(self) -> None:
        ArtefactDialog(self._artefacts, self).open()

    def _choose(self) -> None:
        start = self._check.folder or Path.home()
        folder = ask.choose_folder(self, tr("Folder with the pictures of the check"), start)
        if folder is not None:
            self._check.use_folder(folder)


def _tip(check: PastCheck) -> str:
    """When, how warm and, of an artefact, E_n."""
    warm = [] if check.celsius is None else [f"{number(check.celsius, '.1f')} °C"]
    normalised = [f"E_n = {number(check.e_n, '.2f')}"] if check.artefact else []
    return joined([time_of(check.taken_at), *warm, *normalised])


def facts(
    look: InterimCheck | None, chart: ControlChart | None, artefacts: Sequence[ArtefactCheck]
) -> tuple[Fact, ...]:
    """Make the facts (name, value, unit) on the interim check and on artefacts measured with the same calibrations."""
    of_artefacts = (named(one.artefact.id, artefact_facts(one)) for one in artefacts)
    return (*(check_facts(look, chart) if look is not None else ()), *chain(*of_artefacts))
