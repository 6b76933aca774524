"""Garbage that holds windows is collected in the GUI thread only."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator

import pytest
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication

from workbench.garbage import GarbageCollector


class Cycle(QObject):
    def __init__(self) -> None:
        super().__init__()
        self.me = self


@pytest.fixture
def collector(qapp: QApplication) -> Iterator[GarbageCollector]:
    gc.enable()
    made = GarbageCollector()
    yield made
    made.stop()
    gc.disable()


def _allocate_much() -> list[list[int]]:
    return [[number] for number in range(20_000)]


def test_another_thread_that_allocates_much_destroys_no_object_of_qts(collector: GarbageCollector) -> None:
    gc.collect()
    gone = weakref.ref(Cycle())
    thread = threading.Thread(target=_allocate_much)
    thread.start()
    thread.join()
    assert gone() is not None
    kept = _allocate_much()
    collector.collect_due()
    assert gone() is None
    assert kept


def test_garbage_goes_while_the_window_idles(collector: GarbageCollector, qtbot: object) -> None:
    gone, kept = weakref.ref(Cycle()), _allocate_much()
    qtbot.waitUntil(lambda: gone() is None, timeout=5000)  # type: ignore[attr-defined]
    assert kept


def test_little_garbage_is_left_for_later(collector: GarbageCollector) -> None:
    gc.collect()
    assert collector.collect_due() == 0


def test_python_collects_again_once_the_collector_has_stopped(collector: GarbageCollector) -> None:
    assert not gc.isenabled()
    collector.stop()
    assert gc.isenabled()
