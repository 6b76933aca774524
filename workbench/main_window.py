"""The frame: rail, pages with Back and Next, status bar, messages. It knows steps only through their table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QSize, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import (
    QCloseEvent,
    QDesktopServices,
    QDragEnterEvent,
    QDropEvent,
    QHideEvent,
    QResizeEvent,
    QShowEvent,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QDockWidget,
    QLabel,
    QMainWindow,
    QPushButton,
    QStackedWidget,
    QWidget,
)

from core.remaining import COUNTED, USUAL_S, Remaining, in_words, page_of
from core.translations import languages, own_name
from workbench import first_measurement
from workbench.bench import COMPILES_S, Bench
from workbench.language import language_name, tr
from workbench.menus import OF_A_PAGE, MenuFacts, Menus, why_not
from workbench.notices import Notice
from workbench.pages.presenter import StepPresenter
from workbench.pages.project.actions import ProjectActions
from workbench.pages.project.console import ProjectConsole
from workbench.pages.project.double_click import choose_double_click
from workbench.pages.project.many_sets import ManySets
from workbench.pages.project.operator import OperatorMode
from workbench.pages.project.operator_page import OperatorPage
from workbench.pages.project.presenter import ProjectPresenter
from workbench.pages.project.welcome_page import WelcomePage
from workbench.pages.report.page import ReportPage
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.step_page import StepPage
from workbench.refresh import Refresh
from workbench.step_state import State
from workbench.steps import STEPS
from workbench.theme import apply_theme, icon
from workbench.views import ask
from workbench.views.console import console_missing
from workbench.views.instruction_bar import InstructionBar
from workbench.views.layouts import (
    Elided,
    UpAndDown,
    enable,
    holding,
    in_column,
    in_row,
    keep_focus,
    resize_on_screen,
)
from workbench.views.lists.notice_list import Banner, NoticeList
from workbench.views.lists.step_rail import StepRail
from workbench.views.manual import ManualWindow
from workbench.views.task_bar import StatusBar, TaskBar, time_left
from workbench.window_layout import LayoutOfScreen, keep_layout, restore_layout
from workbench.wing import guard_project, opened_by_entries
from workbench.work import jobs
from workbench.work.jobs import name_of
from workbench.work.tasks import Task

SMALLEST = QSize(950, 470)
"""It is of use down to this size: full HD at twice the size leaves 960 × 540, less the system's bars."""
WIDE, HIGH = 1120, 620
"""From these on, in pixels, there is room for the titles of the steps beside each page and for a line of help above."""


class MainWindow(QMainWindow):
    """Main window of the workbench."""

    language_wanted = Signal(str)
    """Nothing runs and all is saved: the window can be replaced by one that speaks this language."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self.bench, self.model = bench, bench.model
        self._refreshing = Refresh(self._refresh, self)
        self.setWindowTitle("Trisect")
        self.setMinimumSize(SMALLEST)
        resize_on_screen(self, 1280, 800)
        self.setAcceptDrops(True)
        self.projects = ProjectActions(bench, self)
        self._current = ""
        self.model.opened.connect(self._leave_page)  # before the presenters read what the page would show
        self.presenters: dict[str, StepPresenter] = {step.name: step.presenter(bench) for step in STEPS}
        self._scan_presenter().offer_whole(self._project_presenter().whole)
        self.pages: dict[str, StepPage] = {step.name: step.page(self.presenters[step.name]) for step in STEPS}
        self.rail = StepRail([(step.name, tr(step.title), step.icon) for step in STEPS])
        self.notice_list, self.task_bar = NoticeList(), TaskBar()
        texts = dict.fromkeys(tr(each.text) for way in first_measurement.ORDERS.values() for each in way)
        self.instructions = InstructionBar(list(texts))
        self._led_in: Path | None = None
        self.welcome = WelcomePage(self.projects)
        self._title, self._help = QLabel(), Elided()
        self._title.setObjectName("title")
        self._help.setObjectName("muted")
        self.missing = Elided()
        self.missing.setObjectName("muted")
        self.back = QPushButton(tr("Back"))
        self.next = QPushButton(tr("Next"))
        self.next.setProperty("primary", True)
        self._stack, self._pages = QStackedWidget(), QStackedWidget()
        for page in self.pages.values():
            self._pages.addWidget(page)
        self._start, self._steps = UpAndDown(self.welcome), self._wizard()
        self._stack.addWidget(self._start)
        self._stack.addWidget(self._steps)
        self.setCentralWidget(self._stack)
        self._task: Task | None = None
        self._not_done = ""
        self._remaining = Remaining({})
        self._left = False
        self.log_file: Path | None = None
        self.messages = self._messages_dock()
        self.manual = ManualWindow(self)
        self.many_sets = ManySets(bench, self)
        self.console, self._no_console = ProjectConsole(self.model, self), console_missing()
        self.operator_mode = OperatorMode(bench, self._project_presenter().whole)
        self.operator = OperatorPage(self.operator_mode, self.model)
        self._stack.addWidget(self.operator)
        report = self.pages["report"]
        assert isinstance(report, ReportPage)
        undo_stack, commands = self.model.undo_stack, self._commands()
        self.menus = Menus(
            self,
            bench.settings,
            undo_stack,
            commands,
            self.projects.open_project,
            report.export_menu(),
            opened_by_entries(bench, self),
        )
        self._connect()
        self.back.setIcon(icon("mdi6.chevron-left"))
        restore_layout(self, self.pages, bench.settings)
        self._layout_of_screen = LayoutOfScreen(self, self.pages, bench.settings)
        self._project_opened()

    @property
    def current(self) -> str:
        """Name of the step whose page is shown; "" on the welcome page."""
        return self._current

    def go_to(self, name: str) -> None:
        """Show the page of the step called `name`."""
        if not self.model.is_open or name == self._current:
            return
        if self._current:
            self.presenters[self._current].left()
        self._current = name
        self.pages[name].prepare()
        _turn(self._pages, self.pages[name])
        self.rail.set_current(name)
        step = next(step for step in STEPS if step.name == name)
        self._title.setText(tr(step.title))
        self._help.setText(tr(step.help))
        self._title.setToolTip(tr(step.help))
        self.presenters[name].entered()
        self._refresh()

    def go(self, by: int) -> None:
        """Show the page of the step before (−1) or after (1) that is needed, if that is possible."""
        if not self._current:
            return
        names = [
            name
            for name, state in self.model.states.items()
            if name == self._current or state.state is not State.NOT_NEEDED
        ]
        place = names.index(self._current) + by
        if 0 <= place < len(names) and (by < 0 or not self.presenters[self._current].blocker()):
            self.go_to(names[place])

    def enter_operator_mode(self) -> None:
        """Save the project, and show the page of the operator mode with its four buttons."""
        if self.model.is_open and not self.operator_mode.on and (self.model.is_read_only or self.projects.save()):
            self.messages.hide()
            self.operator_mode.turn(True)
            self._show_mode()

    def leave_operator_mode(self) -> None:
        """Leave the operator mode for all pages; if people have roles, only after an inspector's PIN."""
        if self.operator_mode.on and self.model.guard.may_leave_operator_mode():
            self.operator_mode.turn(False)
            self._show_mode()

    def presenter_action(self, name: str, page: str = "") -> None:
        """Run the action of a shortcut, "run", "accept", "live" or "capture", on a page; "" is the current one."""
        action = getattr(self.presenters.get(page or self._current), f"do_{name}", None)
        if action is not None:
            action()

    def cancel_task(self) -> None:
        """Cancel the running job."""
        if self._task is not None:
            self.task_bar.cancelling()
            self._task.cancel()

    def apply_theme(self, name: str) -> None:
        """Apply a theme to the whole program: "light", "dark" or "system"."""
        app = QApplication.instance()
        if isinstance(app, QApplication):
            apply_theme(app, name)

    def follow_system(self, *_: Any) -> None:
        """Apply the theme again, because the system has changed between light and dark."""
        self.apply_theme(self.bench.settings.theme)

    def leave(self) -> bool:
        """Ask about unsaved work, stop what runs, save, and close; False if the window does not close now."""
        if not self._left:
            self.projects.leave(self._leave_now)
        return self._left

    def dismiss(self) -> None:
        """Close this window, which another one replaces; the project stays open."""
        self._left = True
        self._close_pages()
        for presenter in self.presenters.values():
            presenter.deleteLater()
        self.hide()
        self.deleteLater()

    def _close_pages(self) -> None:
        keep_layout(self, self.pages, self.bench.settings)
        self.bench.settings.flush()
        self.console.end(wait=True)
        for page in self.pages.values():
            page.close()

    def _leave_now(self) -> None:
        self._close_pages()
        self.bench.close()
        self._left = True
        self.close()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._layout_of_screen.follow()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._layout_of_screen.rest()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Close the window once `leave` has agreed; its questions are asked after this event."""
        event.setAccepted(self._left)
        if not self._left:
            QTimer.singleShot(0, self, self.leave)

    def focusNextPrevChild(self, next: bool) -> bool:
        """Move the focus by Tab; Qt also calls it when the widget with the focus is disabled or hidden."""
        return keep_focus(self) or super().focusNextPrevChild(next)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.ActivationChange:
            keep_focus(self)  # what had the focus may have been hidden while a question was in front

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._give_room()
        self._help.setVisible(self.height() >= HIGH)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if _dropped(event):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        path = _dropped(event)
        if path is not None and not self._operator_seen:
            self.projects.open_dropped(path)

    def _wizard(self) -> QWidget:
        self.missing.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._head = holding(in_column(self._title, self._help, margins=(14, 6, 14, 0), spacing=1))
        self._foot = holding(in_row(self.back, (self.missing, 1), self.next, margins=(14, 4, 14, 4)))
        page = holding(in_column(self._head, self.instructions, (self._pages, 1), self._foot, spacing=2))
        self.banner = Banner(page, self._head)
        whole = QWidget()
        in_row(self.rail, (page, 1), on=whole, spacing=0)
        return whole

    def _messages_dock(self) -> QDockWidget:
        dock = QDockWidget(tr("Messages"), self)
        dock.setObjectName("messages")
        dock.setWidget(self.notice_list)
        dock.setFeatures(QDockWidget.DockWidgetFeature.DockWidgetClosable)
        self.addDockWidget(Qt.DockWidgetArea.BottomDockWidgetArea, dock)
        dock.hide()
        self._messages_button = QPushButton(tr("Messages"))
        self._messages_button.setIcon(icon("mdi6.message-text-outline"))
        self._messages_button.setFlat(True)
        self._messages_button.setObjectName("low")
        self._messages_button.setIconSize(QSize(14, 14))
        self._messages_button.clicked.connect(self._toggle_messages)
        self.setStatusBar(StatusBar())
        self.statusBar().addPermanentWidget(self.task_bar)
        self.statusBar().addPermanentWidget(self._messages_button)
        return dock

    def _commands(self) -> Mapping[str, Callable[[], object]]:
        """What the entries of the menus do, by their names."""
        projects = self.projects
        return {
            "new": projects.new_project,
            "open": projects.choose_project,
            "open set": projects.choose_set,
            "import": projects.import_pictures,
            "sample": projects.open_sample,
            "simulated": projects.try_simulated,
            "simulated without fan": projects.try_simulated_without_fan,
            "save": projects.save,
            "next part": projects.begin_next_part,
            "copy": projects.copies.save_copy,
            "pack": projects.copies.pack,
            "unpack": projects.copies.choose_packed,
            "close": projects.close_project,
            "quit": self.leave,
            **{name: partial(self.presenter_action, name) for name in OF_A_PAGE},
            "whole": partial(self.presenter_action, "whole", "project"),
            "cancel": self.cancel_task,
            "back": partial(self.go, -1),
            "next": partial(self.go, 1),
            **{f"step {step.name}": partial(self.go_to, step.name) for step in STEPS},
            "messages": self._toggle_messages,
            "manual": self._open_manual,
            "first measurement": projects.begin_first_measurement,
            "first measurement, no fan": projects.begin_first_measurement_without_fan,
            "quick card": self._print_quick_card,
            "console": self.console.open,
            "many sets": self.many_sets.open,
            "script": projects.copies.save_script,
            "operator mode": self.enter_operator_mode,
            "double click": partial(choose_double_click, self, self.bench.notices),
            "log": self._open_log,
        }

    def _open_manual(self) -> None:
        """The manual, at the page of the step one is at."""
        page = next((step.manual for step in STEPS if step.name == self._current), "index")
        self.manual.open_page(page)

    def _print_quick_card(self) -> None:
        """The page to hang beside the rig, in the language of the window."""
        start = Path.home() / tr("Trisect quick card.pdf")
        path = ask.choose_file_to_save(self, tr("Quick card"), start, tr("PDF (*.pdf)"))
        if path is not None:
            name = language_name() if language_name() in languages() else "en"
            self.bench.run_quick(
                self,
                jobs.QUICK_CARD,
                path,
                name,
                label=tr("Drawing the quick card"),
                on_done=lambda done: self.bench.notices.info(tr("The quick card was written to {path}.", path=done)),
                offers={},
            )

    def _connect(self) -> None:
        self.rail.chosen.connect(self.go_to)
        self.back.clicked.connect(lambda: self.go(-1))
        self.next.clicked.connect(lambda: self.go(1))
        self.model.opened.connect(self._project_opened)
        self.model.changed.connect(self._refreshing.soon)
        self.model.results_changed.connect(self._refreshing.soon)
        self.model.modified.connect(self._show_name)
        self.model.failed.connect(self.bench.notices.failed)
        guard_project(self.bench, self)
        for presenter in self.presenters.values():
            presenter.changed.connect(self._refreshing.soon)
            presenter.go_to.connect(self.go_to)
        for notice in self.bench.notices.all:  # wings that cannot be used are told while the window is made
            self._on_notice(notice)
        self.bench.notices.added.connect(self._on_notice)
        self.bench.settings.language_changed.connect(self._on_language)
        lane = self.bench.measuring
        lane.task_started.connect(self._task_started)
        lane.task_progressed.connect(self._task_progressed)
        lane.task_ended.connect(self._task_ended)
        lane.preparing_changed.connect(self._on_preparing)
        self._on_preparing(lane.preparing)
        self.task_bar.cancel_pressed.connect(self.cancel_task)
        self.operator.stop.connect(self.cancel_task)
        self.operator.next_part.connect(self.projects.begin_next_part)
        self.operator.leave.connect(self.leave_operator_mode)
        self.task_bar.tick.connect(self._show_progress)
        self.projects.go_to.connect(self.go_to)
        self.projects.first_measurement_begun.connect(self._begin_instructions)
        self.instructions.left.connect(self._leave_instructions)
        self.instructions.show_me.connect(self._show_where)

    @property
    def _operator_seen(self) -> bool:
        """Whether the operator's page is shown: not while the next part's project is not open yet."""
        return self.operator_mode.on and self.model.is_open

    def _project_presenter(self) -> ProjectPresenter:
        presenter = self.presenters["project"]
        assert isinstance(presenter, ProjectPresenter)
        return presenter

    def _scan_presenter(self) -> ScanPresenter:
        presenter = self.presenters["scan"]
        assert isinstance(presenter, ScanPresenter)
        return presenter

    def _show_mode(self) -> None:
        """The operator's page, or that of the step."""
        self.operator.refresh()
        _turn(self._stack, self.operator if self.operator_mode.on else self._steps)
        self._refresh()

    def _leave_page(self) -> None:
        """Tell the page that was shown that it no longer is: another project is open, or none."""
        if self._current:
            self.presenters[self._current].left()
        self._current = ""

    def _project_opened(self) -> None:
        self.banner.hide()
        self.operator.banner.hide()
        if self.model.is_open:
            self.go_to("project")
            self._show_mode()
        else:
            _turn(self._stack, self._start)
            self.welcome.refresh()
        self._show_name()
        self._refresh()

    def _begin_instructions(self) -> None:
        self._led_in = self.model.folder
        self._refresh()

    def _leave_instructions(self) -> None:
        self._led_in = None
        self.instructions.hide()

    def _instruction(self) -> first_measurement.Instruction:
        """What to do next in the first measurement."""
        solved = (name for name, presenter in self.presenters.items() if presenter.waits_to_be_accepted)
        states = {name: state.state for name, state in self.model.states.items()}
        has_fan = self.model.project.rig.has_fan
        facts = first_measurement.Facts(self._current, states, frozenset(solved), self._is_working, has_fan)
        return first_measurement.instruction(facts)

    @property
    def _is_working(self) -> bool:
        """Whether what to do next is not known yet: something is calibrated or measured."""
        return self._task is not None or any(one.is_working for one in self.presenters.values())

    def _show_instruction(self) -> None:
        if self._led_in is None or self._led_in != self.model.folder:
            self._leave_instructions()
            return
        now, waiting = self._instruction(), self._is_working
        order = first_measurement.ORDERS[self.model.project.rig.has_fan]
        number, count = order.index(now) + 1, len(order)
        text = tr(first_measurement.WAIT if waiting else now.text)
        can_show = not waiting and now is not first_measurement.FINISHED
        self.instructions.show_instruction(number, count, text, can_show=can_show)

    def _show_where(self) -> None:
        """Go to what the instruction means, and have it under the keyboard."""
        now = self._instruction()
        self.go_to(now.page)
        (self.pages[now.page].card.buttons[now.button] if now.button else self.next).setFocus()

    def _refresh(self) -> None:
        facts = self._menu_facts()
        self.menus.refresh(facts)
        if not self.model.is_open:
            return
        self._show_instruction()
        self._give_room()
        states = self.model.states
        self.rail.set_states({name: (str(state.state), state.sentence) for name, state in states.items()})
        last = why_not("next", facts)
        missing = self.presenters[self._current].blocker() if self._current else ""
        enable(self.next, last or missing, tr("Go on to the next step"))
        self.next.setVisible(not last)
        self.missing.setText("" if last else missing)
        enable(self.back, why_not("back", facts), tr("Go back to the step before"))

    def _give_room(self) -> None:
        """What can only be done later is not seen while a page takes the window."""
        taken = bool(self._current) and self.pages[self._current].takes_the_window
        self._head.setVisible(not taken)
        self._foot.setVisible(not taken)
        self.instructions.setVisible(not taken and self._led_in is not None)
        self.rail.set_narrow(taken or self.width() < WIDE)

    def _menu_facts(self) -> MenuFacts:
        page = self.presenters.get(self._current)
        does = frozenset(name for name in OF_A_PAGE if hasattr(page, f"do_{name}"))
        return MenuFacts(
            self._current, does, job=self._task is not None, operator=self._operator_seen, no_console=self._no_console
        )

    def _toggle_messages(self) -> None:
        self.messages.setVisible(not self.messages.isVisible())

    def _open_log(self) -> None:
        if self.log_file is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.log_file.parent)))

    def _show_name(self, *_: Any) -> None:
        if not self.model.is_open:
            self.setWindowTitle("Trisect")
            self.setWindowModified(False)
            return
        name = self.model.project.info.name or tr("Unnamed project")
        if self.model.is_read_only:
            name = tr("{name} (read only)", name=name)
        self.setWindowTitle(f"{name}[*] – Trisect")
        self.setWindowModified(self.model.is_modified)

    def _on_language(self, name: str) -> None:
        if name == language_name():
            return
        if self.bench.measuring.current is None and not self.model.is_recording:
            self.projects.leave(partial(self.language_wanted.emit, name))
            return
        said = tr("The window speaks {language} when it is opened the next time.", language=own_name(name))
        self.bench.notices.info(said)

    def _on_notice(self, notice: Notice) -> None:
        self.notice_list.add(str(notice.level), notice.text, notice.details, notice.at.strftime("%H:%M:%S"))
        if notice.level != "info":
            open_banner = self.operator.banner if self._operator_seen else self.banner
            (open_banner if self.model.is_open else self.welcome.banner).show_notice(
                str(notice.level), notice.text, notice.details
            )
            self._not_done = notice.job
        else:
            self.statusBar().showMessage(notice.text, 8000)
        self._messages_button.setText(tr("Messages ({n})", n=self.notice_list.count()))

    def _on_preparing(self, preparing: bool) -> None:
        """Say that the program makes itself ready, which it does once, and nothing any more when it has."""
        said = tr("Preparing once, about {time} …", time=in_words(COMPILES_S))
        if preparing:
            self.statusBar().showMessage(said)
        elif self.statusBar().currentMessage() == said:
            self.statusBar().clearMessage()

    def _task_started(self, task: Task) -> None:
        if self._not_done == task.job:  # what kept it from being done is mended, or is told anew
            self.banner.hide()
            self.operator.banner.hide()
            self.welcome.banner.hide()
        self._task = task
        self._stage, self._counted = "", (0, 0)
        name = name_of(task.job)
        self._remaining = Remaining(USUAL_S.get(name, {}), self.bench.settings.stage_seconds(name))
        self.task_bar.begin(task.label)
        self._refreshing.soon()

    def _task_progressed(self, _: Task, stage: str, done: int, total: int) -> None:
        self._stage, self._counted = stage, (done, total)
        self._remaining.report(stage, done, total)
        self._show_progress()

    def _show_progress(self) -> None:
        if self._task is None or self._task.cancelling:
            return
        words = time_left(self._remaining.left)
        label, stage = self._what_goes_on(self._task)
        self.task_bar.progress(label, stage, self._remaining.share, words)
        self.operator.show_progress(tr(self._stage), self._remaining.share, words)

    def _what_goes_on(self, task: Task) -> tuple[str, str]:
        """The step of how many, or the job where it has one alone; and the stage, with the number of its pictures."""
        (done, total), stage = self._counted, tr(self._stage)
        if self._stage in COUNTED and total > 1:
            stage = tr("{stage}, {done} of {total}", stage=stage, done=done, total=total)
        place = page_of(name_of(task.job), self._stage)
        if place is None:
            return task.label, stage
        number, count, name = place
        title = next(tr(step.title) for step in STEPS if step.name == name)
        return tr("{number} of {count}, {step}", number=number, count=count, step=title), stage

    def _task_ended(self, task: Task) -> None:
        if task is self._task:
            if task.succeeded:
                self.bench.settings.keep_stage_seconds(name_of(task.job), self._remaining.finish())
            self._task = None
            self.task_bar.end()
            self._refreshing.soon()


def _turn(stack: QStackedWidget, page: QWidget) -> None:
    """Show a page. Qt gives it the focus that was on the page before, but not to one of its buttons."""
    stack.setCurrentWidget(page)
    arrived_at = stack.window().focusWidget()
    if isinstance(arrived_at, QAbstractButton) and page.isAncestorOf(arrived_at):
        page.setFocus()


def _dropped(event: QDragEnterEvent | QDropEvent) -> Path | None:
    urls = [url for url in event.mimeData().urls() if url.isLocalFile()]
    return Path(urls[0].toLocalFile()) if urls else None
