"""The lanes of a bench and the Inspect page, as the tests of the page have them."""

from tests.workbench.pages.inspect.conftest import measuring, quick, show_page

__all__ = ["measuring", "quick", "show_page"]
