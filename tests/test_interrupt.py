import contextlib
import signal

import pytest

from core.cli.bar import bar
from core.errors import Cancelled


def test_an_interrupt_lost_in_a_finaliser_still_cancels_at_the_next_progress():
    with bar() as progress:
        progress("frames", 0, 3)
        with contextlib.suppress(KeyboardInterrupt):  # as a finaliser would
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(Cancelled):
            progress("frames", 1, 3)


def test_afterwards_an_interrupt_is_pythons_own_again():
    before = signal.getsignal(signal.SIGINT)
    with bar():
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before
