"""Studies of the Inspect page on a real scan, in real processes."""

import pytest

from tests.workbench.pages.inspect.test_real import presenter
from tests.workbench.tabs import tab_titled
from tests.workbench.watchdog import Watchdog, slowness, too_long

__all__ = ["presenter"]

READINGS = "part;operator;value\n" + "".join(f"{i % 5};{i // 5 % 2};{i * i % 7}\n" for i in range(20))


@pytest.mark.accuracy
def test_studies_never_keep_the_window_waiting(presenter, qtbot, monkeypatch):
    from workbench.pages.inspect.page import InspectPage

    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
    page = InspectPage(presenter)
    qtbot.addWidget(page)
    page.resize(1100, 700)
    page.show()
    qtbot.wait(300)
    tab = tab_titled(page.tabs, "Studies")
    studies = tab.studies
    with Watchdog(lambda: studies.draft.kind if studies.draft else "") as watchdog:
        page.tabs.setCurrentWidget(tab)
        for kind in ("grr", "acceptance", "series", "grr"):
            studies.begin(kind)
            qtbot.wait(40)
            assert tab.editor.isVisible()
        studies.write(READINGS)
        studies.finish()
        qtbot.waitUntil(lambda: studies.study is not None and not studies.working, timeout=60_000)
        qtbot.wait(40)
        assert len(tab.table.rows()) > 4
    page.close()
    assert too_long(watchdog, slowness()) == []
