"""Lists and tables, under one roof."""

from __future__ import annotations

from workbench.views.data_table import DataTable
from workbench.views.view_list import ViewList
from workbench.views.view_rows import ListRow

__all__ = ["DataTable", "ListRow", "ViewList"]
