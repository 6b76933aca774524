"""The language of the window: every text that a technician reads goes through here.

One catalogue serves core's messages and the window's own words. It is chosen before a window is built: where another
one is chosen, the window is replaced.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime
from typing import Any

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QObject, QTranslator
from PySide6.QtGui import QFontDatabase, QFontInfo
from PySide6.QtWidgets import QApplication

from core.errors import InputError, WrongValue
from core.messages import Language, Message, capital, label
from core.translations import languages
from workbench.work.worker import ENDED, Failure

_FIELDS = {
    "[camera_target]": label("the target"),
    "laser_fan.lines": label("the number of lines under Laser"),
    "plane_target.kind": label("the kind of plate"),
    "plane_target.scale_sd": label("u of its size"),
    "plane_target.flatness_mm": label("its flatness"),
    "camera_target.scale_sd": label("u of its size"),
    "part.material": label("Material"),
    "part.celsius": label("Temperature"),
    "target.inner_corners": label("columns and rows of the target"),
    "target.circles": label("columns and rows of the target"),
    "target.dictionary": label("markers of the target"),
    "target.columns, rows and dictionary": label("columns, rows and markers"),
    "target.columns and rows": label("columns and rows"),
    "target.size": label("size"),
}
"""What the window calls the fields of the files that people write for the command line."""

_ELSEWHERE = Message(
    "window.elsewhere", "make the folder writable, or copy the project to another disk and open it there"
)
_INSTEAD = {
    "advice.another_out": _ELSEWHERE,
    "advice.results_into_set": Message("window.another_folder", "choose another folder"),
    "advice.name_results_folder": Message("window.results_folder", "choose the folder of its results"),
    "profile.advice_tilt": Message(
        "window.profile_tilt", "name the plate's pose on the stage, or say to how many degrees the tilt is known"
    ),
    "advice.another_characteristic": Message("window.another_result", "choose another result"),
    "artefact.advice_name_it": Message("artefact.advice_name_one", "name one of these"),
    "gauge.where_upper_region": Message("gauge.upper_region", "region of the upper face"),
    "gauge.where_lower_region": Message("gauge.lower_region", "region of the lower face"),
    "gauge.advice_exchange_faces": Message("gauge.advice_exchange_regions", "exchange the two regions"),
    "gauge.advice_outline_faces": Message(
        "gauge.advice_draw_regions", "scan both faces, or draw a region on each of them"
    ),
}
"""What the window says in place of an option of the command line or a key of its files, by the code of that."""


def _for_the_window(language: Language) -> Language:
    fields = {key: language.label(english) for key, english in _FIELDS.items()}
    instead = {code: language(message) for code, message in _INSTEAD.items()}
    return replace(language, messages={**language.messages, **instead}, fields=fields, commands=False)


_chosen = _for_the_window(Language())
_of_qt: QTranslator | None = None
"""Qt's own words, as on the buttons of its dialogs."""

FONTS = {
    "zh_CN": ("Sans CJK SC", "Han Sans SC", "Sans SC", "YaHei UI", "YaHei", "PingFang SC", "MicroHei", "Micro Hei"),
}
"""In the names of fonts, the best first, whose characters are a language's: East Asian ones differ by country."""


def choose(language: Language, parent: QObject) -> None:
    """Set the language of all windows built from now on; windows that exist keep their language."""
    global _chosen, _of_qt
    _chosen = _for_the_window(language)
    if _of_qt is not None:
        QCoreApplication.removeTranslator(_of_qt)
    _of_qt = QTranslator(parent)
    if _of_qt.load(f"qtbase_{language.name}", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)):
        QCoreApplication.installTranslator(_of_qt)
    _write_as(language.name)


def _write_as(name: str) -> None:
    """Have windows that are built from now on draw a language's characters as it writes them."""
    font = QApplication.font()
    there = QFontDatabase.families() if name in FONTS else []
    found = [family for part in FONTS.get(name, ()) for family in there if part in family][:1]
    if not found and len(font.families()) < 2:
        return
    font.setFamilies([QFontInfo(font).family(), *found])
    QApplication.setFont(font)


def chosen() -> Language:
    """Return the language in which the window is written."""
    return _chosen


def language_name() -> str:
    """Return the name of the window's language, as "de"."""
    return _chosen.name


def printed() -> str:
    """Return the name of the language of reports for which none is chosen: the window's, or "en" if it has none."""
    return language_name() if language_name() in languages() else "en"


def tr(english: str, /, **values: Any) -> str:
    """Translate fixed English words, with `values` in their places: `tr("{n} of {m} frames", n=3, m=5)`."""
    return _chosen.label(english, **values)


def text_of(message: Message | Exception | Failure | str) -> str:
    """Translate a message, an error or a failure of a job into the window's language; any other text stays as it is."""
    if isinstance(message, Failure):
        if message.kind == ENDED:
            return tr("The process that does this ended unexpectedly. What was recorded and measured before is kept.")
        return tr("Something went wrong in the program; your work is kept. Details: {details}", details=str(message))
    if isinstance(message, InputError):
        return message.text_in(_chosen)
    if isinstance(message, WrongValue):
        return _chosen(message.what)
    return _chosen(message) if isinstance(message, Message) else str(message)


def joined(texts: Iterable[str], how: str = "") -> str:
    """Join texts to a list in the window's language: by commas, or with `how` ";" or "and"."""
    return _chosen.joined(list(texts), how)


def sentences(*texts: str) -> str:
    """Join sentences to one text in the window's language; empty ones are left out."""
    row = " ".join(filter(None, texts))
    return row.replace("。 ", "。")


def sentence(text: str) -> str:
    """Add the full stop of the window's language to a text."""
    return _chosen(Message("input.what", "{what}.", what=capital(text)))


def named(name: str, text: str) -> str:
    """Write a name, the colon of the window's language, and a text."""
    return tr("{name}: {value}", name=name, value=text)


def numeral(digits: str) -> str:
    """Convert a number written by Python to the window's decimal sign and a true minus sign."""
    return _chosen.numeral(digits)


def time_of(at: datetime, *, seconds: bool = False) -> str:
    """Format date and local time of day in the window's language."""
    return _chosen.time(at.astimezone(), seconds=seconds)


def number(value: float, spec: str = "") -> str:
    """Format a number by the format `spec` in the window's language."""
    return _chosen.number(value, spec)
