import threading
import time
from pathlib import Path

import pytest

from core.acquire.folder import read_ahead


def test_order_is_kept_whatever_takes_longest():
    paths = [Path(str(i)) for i in range(20)]

    def read(path):
        time.sleep(0.01 if int(path.name) % 3 == 0 else 0.0)
        return int(path.name)

    assert [value for _, value in read_ahead(paths, read)] == list(range(20))


def test_no_more_than_asked_are_read_before_they_are_wanted():
    read, lock = [], threading.Lock()

    def note(path):
        with lock:
            read.append(path)

    stream = read_ahead((Path(str(i)) for i in range(1000)), note)
    next(stream)
    next(stream)
    time.sleep(0.02)
    assert len(read) <= 7
    stream.close()


def test_an_error_comes_when_its_turn_comes():
    def read(path):
        if path.name == "2":
            raise ValueError("two")
        return path.name

    stream = read_ahead([Path(str(i)) for i in range(5)], read)
    assert next(stream)[1] == "0"
    assert next(stream)[1] == "1"
    with pytest.raises(ValueError, match="two"):
        next(stream)
