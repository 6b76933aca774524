"""Opening projects by double click: what is written, that it can be taken back, and that it opens the project."""

from __future__ import annotations

import configparser
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from core.errors import InputError
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, put_opener
from workbench import app
from workbench.bench import Bench
from workbench.pages.project import double_click
from workbench.pages.project.actions import ProjectActions
from workbench.pages.project.double_click import choose_double_click
from workbench.views import ask

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="freedesktop.org's files")

SPECIFIED = "{http://www.freedesktop.org/standards/shared-mime-info}"


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's own entries, in a temporary folder."""
    folder = tmp_path / "share"
    monkeypatch.setenv("XDG_DATA_HOME", str(folder))
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def entry(data: Path) -> configparser.SectionProxy:
    parser = configparser.ConfigParser(interpolation=None, strict=True)
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    parser.read(data / "applications" / "trisect.desktop", encoding="utf-8")
    return parser["Desktop Entry"]


def test_the_entry_starts_the_program_with_the_file_and_names_the_kind_of_file(data: Path) -> None:
    double_click.install(("/opt/tri sect/bin/trisect-workbench",))
    desktop = entry(data)
    assert desktop["Type"] == "Application" and desktop["Terminal"] == "false"
    assert desktop["Exec"] == '"/opt/tri sect/bin/trisect-workbench" %f'
    assert desktop["MimeType"] == "application/x-trisect-project;application/x-trisect-packed;"
    root = ElementTree.parse(data / "mime" / "packages" / "trisect.xml").getroot()
    globs = {
        kind.get("type"): [glob.get("pattern") for glob in kind.iter(f"{SPECIFIED}glob")]
        for kind in root.iter(f"{SPECIFIED}mime-type")
    }
    assert globs == {"application/x-trisect-project": ["*.trisect"], "application/x-trisect-packed": ["*.trisectz"]}
    assert "<svg" in (data / "icons" / "hicolor" / "scalable" / "apps" / "trisect.svg").read_text()


def test_signs_that_mean_something_in_an_entry_are_escaped(data: Path) -> None:
    double_click.install(('/a "b"/50%/$x', "-m"))
    assert entry(data)["Exec"] == r'"/a \\"b\\"/50%%/\\$x" "-m" %f'


def test_doing_it_twice_changes_nothing_and_taking_it_back_leaves_nothing_of_it(data: Path) -> None:
    assert not double_click.installed()
    (data / "applications").mkdir(parents=True)
    (data / "applications" / "other.desktop").write_text("[Desktop Entry]\n")
    first = double_click.install()
    once = contents(data)
    times = {path: path.stat().st_mtime_ns for path in first.files}
    assert double_click.install() == first
    assert contents(data) == once
    assert {path: path.stat().st_mtime_ns for path in first.files} == times
    assert double_click.installed()
    gone = double_click.uninstall()
    assert set(gone.files) == set(first.files) and not any(path.exists() for path in first.files)
    assert (data / "applications" / "other.desktop").exists() and not double_click.installed()
    assert double_click.uninstall().files == ()


@pytest.mark.skipif(not shutil.which("update-mime-database"), reason="shared-mime-info is not installed")
def test_the_system_knows_the_kind_of_file_then(data: Path) -> None:
    double_click.install()
    assert "application/x-trisect-project:*.trisect" in (data / "mime" / "globs").read_text()
    double_click.uninstall()
    globs = data / "mime" / "globs"
    assert not globs.exists() or "trisect" not in globs.read_text()


def test_where_the_systems_own_programs_are_missing_it_says_what_to_do(
    data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert "Log in again" in double_click.install().sentence


def test_a_folder_that_cannot_be_written_to_is_told_in_a_sentence(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data.mkdir()
    (data / "mime").write_text("a file stands here")
    assert app.main(["--install-desktop"]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_the_command_line_installs_and_takes_back_without_opening_a_window(tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path / "share"), "QT_QPA_PLATFORM": "none"}
    for option, there in (("--install-desktop", True), ("--uninstall-desktop", False)):
        done = subprocess.run(
            [sys.executable, "-m", "workbench", option], env=environment, capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "share" / "applications" / "trisect.desktop").exists() is there
        assert "double click" in done.stdout and "trisect.desktop" in done.stdout


def test_every_project_has_one_file_to_click_on_and_it_opens_the_project(
    hand_bench: Bench, tmp_path: Path, qtbot: Any
) -> None:
    folder = tmp_path / "Block 50"
    create_project(folder, ProjectFile(new_project("Block 50")))
    opener = folder / "Block 50.trisect"
    assert opener.exists()
    opener.rename(folder / "renamed.trisect")
    create_project(folder, ProjectFile(new_project("Block 51")))
    put_opener(folder)
    assert [path.name for path in folder.glob("*.trisect")] == ["renamed.trisect"]
    from PySide6.QtWidgets import QWidget

    window = QWidget()
    qtbot.addWidget(window)
    ProjectActions(hand_bench, window).open_dropped(folder / "renamed.trisect")
    assert hand_bench.model.folder == folder


def test_an_opener_in_a_folder_without_a_project_says_so(hand_bench: Bench, tmp_path: Path, qtbot: Any) -> None:
    from PySide6.QtWidgets import QWidget

    window = QWidget()
    qtbot.addWidget(window)
    told: list[str] = []
    hand_bench.notices.added.connect(lambda notice: told.append(notice.text))
    (tmp_path / "lost.trisect").write_text("")
    ProjectActions(hand_bench, window).open_dropped(tmp_path / "lost.trisect")
    assert not hand_bench.model.is_open and "neither a project" in told[0]


@pytest.mark.parametrize(
    ("there", "answer", "after"),
    [(False, 0, True), (False, 1, False), (True, 0, True), (True, 1, False), (True, 2, True)],
)
def test_the_menu_asks_does_it_and_tells_what_it_did(
    hand_bench: Bench, data: Path, monkeypatch: pytest.MonkeyPatch, there: bool, answer: int, after: bool
) -> None:
    if there:
        double_click.install()
    asked: list[list[str]] = []

    def chosen(_parent: Any, _title: str, _text: str, answers: list[str], **_: Any) -> int:
        asked.append(answers)
        return answer

    monkeypatch.setattr(ask, "ask", chosen)
    told: list[Any] = []
    hand_bench.notices.added.connect(told.append)
    choose_double_click(None, hand_bench.notices)  # type: ignore[arg-type]
    assert double_click.installed() is after
    left = answer == len(asked[0]) - 1
    assert len(told) == (0 if left else 1)
    if not left:
        assert "trisect.desktop" in told[0].details


def test_where_files_are_tied_to_bundles_it_says_what_to_do_instead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(double_click, "PLATFORM", "darwin")
    assert not double_click.installed()
    refused: Callable[[], object]
    for refused in (double_click.install, double_click.uninstall):
        with pytest.raises(InputError, match="bundles"):
            refused()


def test_on_windows_the_users_own_classes_name_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The registry's place is taken by a file: what is written into it, and that it goes again."""
    from PySide6.QtCore import QSettings

    file = tmp_path / "registry.ini"
    monkeypatch.setattr(double_click, "PLATFORM", "win32")
    monkeypatch.setattr(double_click, "_classes", lambda: QSettings(str(file), QSettings.Format.IniFormat))
    double_click.install((r"C:\Trisect\trisect-workbench.exe",))
    classes = QSettings(str(file), QSettings.Format.IniFormat)
    assert classes.value(".trisect/.") == "Trisect.Project"
    assert classes.value("Trisect.Project/shell/open/command/.") == '"C:\\Trisect\\trisect-workbench.exe" "%1"'
    assert double_click.installed()
    double_click.uninstall()
    assert not double_click.installed()
    assert QSettings(str(file), QSettings.Format.IniFormat).allKeys() == []
