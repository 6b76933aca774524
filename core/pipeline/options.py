"""What a run can be told; kept with a project, and therefore among the files."""

from core.files.options import METHODS, Options

__all__ = ["METHODS", "Options"]
