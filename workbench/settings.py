"""What the program remembers between sessions; nothing in it belongs to a project."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QObject, QSettings, Signal

RECENT = 8
"""So many projects are remembered."""

THEMES = ("system", "light", "dark")


class AppSettings(QObject):
    """User's own settings, stored by Qt in the usual place of each system, or in `file` (for tests)."""

    recent_changed = Signal()
    theme_changed = Signal(str)
    language_changed = Signal(str)
    part_frame_changed = Signal()

    def __init__(self, file: Path | None = None, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = QSettings(str(file), QSettings.Format.IniFormat) if file else QSettings("trisect", "workbench")

    @property
    def recent(self) -> list[Path]:
        """Folders of the projects opened last, the newest first, without those that are gone."""
        stored = self._store.value("recent", [])
        paths = [stored] if isinstance(stored, str) else stored if isinstance(stored, list) else []
        return [path for path in map(Path, paths) if (path / "project.json").exists()]

    def remember(self, project: Path) -> None:
        """Put a project's folder at the top of the list of recent projects."""
        self._keep_recent([project, *(path for path in self.recent if path != project)])

    def forget(self, project: Path) -> None:
        """Remove a project's folder from the list of recent projects; the project stays."""
        self._keep_recent([path for path in self.recent if path != project])

    @property
    def theme(self) -> str:
        """Name of the chosen theme, one of THEMES."""
        theme = str(self._store.value("theme", "system"))
        return theme if theme in THEMES else "system"

    @theme.setter
    def theme(self, name: str) -> None:
        self._store.setValue("theme", name)
        self.theme_changed.emit(name)

    @property
    def language(self) -> str:
        """Name of the language chosen for the window; "" for the system's."""
        return str(self._store.value("language", ""))

    @language.setter
    def language(self, name: str) -> None:
        self._store.setValue("language", name)
        self.language_changed.emit(name)

    @property
    def part_frame(self) -> bool:
        """Whether 3D views use the part's own frame, where it is known, instead of the camera's."""
        return self.text("frame of 3D views", "part") == "part"

    @part_frame.setter
    def part_frame(self, wanted: bool) -> None:
        self.keep_text("frame of 3D views", "part" if wanted else "camera")
        self.part_frame_changed.emit()

    @property
    def callouts(self) -> bool:
        """Whether results are shown as callouts at their places on the surface."""
        return self.text("callouts", "shown") == "shown"

    @callouts.setter
    def callouts(self, wanted: bool) -> None:
        self.keep_text("callouts", "shown" if wanted else "hidden")

    @property
    def nominal_shown(self) -> bool:
        """Whether the nominal surface is shown over the part while a deviation from it is chosen."""
        return self.text("nominal", "hidden") == "shown"

    @nominal_shown.setter
    def nominal_shown(self, wanted: bool) -> None:
        self.keep_text("nominal", "shown" if wanted else "hidden")

    @property
    def projects_folder(self) -> Path:
        """Folder in which new projects are made."""
        return Path(str(self._store.value("projects_folder", Path.home() / "Trisect projects")))

    @projects_folder.setter
    def projects_folder(self, folder: Path) -> None:
        self._store.setValue("projects_folder", str(folder))

    def text(self, name: str, default: str) -> str:
        """Return the stored text called `name`; `default` if none is stored."""
        return str(self._store.value(name, default))

    def keep_text(self, name: str, value: str) -> None:
        """Store a text called `name`."""
        self._store.setValue(name, value)

    def layout(self, name: str) -> QByteArray | None:
        """Return the stored geometry of the window or splitter called `name`; None if none is stored."""
        value = self._store.value(f"layout/{name}")
        return value if isinstance(value, QByteArray) else None

    def keep_layout(self, name: str, state: QByteArray) -> None:
        """Store the geometry of the window or splitter called `name`."""
        self._store.setValue(f"layout/{name}", state)

    def stage_seconds(self, job: str) -> dict[str, float]:
        """Return how long each stage of this job took last time in s, by stage, to estimate the time left."""
        stored = self._store.value(f"stages/{job}", {})
        return {str(k): float(v) for k, v in stored.items()} if isinstance(stored, dict) else {}

    def keep_stage_seconds(self, job: str, seconds: dict[str, float]) -> None:
        """Store how long each stage of a job took in s, by stage; other stages keep their values."""
        self._store.setValue(f"stages/{job}", {**self.stage_seconds(job), **seconds})

    def _keep_recent(self, paths: list[Path]) -> None:
        self._store.setValue("recent", [str(path) for path in paths[:RECENT]])
        self.recent_changed.emit()

    def flush(self) -> None:
        """Write the settings to the disk now."""
        self._store.sync()
