"""Complaints about a thickness as a project's user meets them: regions are drawn there, not written into rig.toml."""

from __future__ import annotations

from core.errors import InputError


def in_a_project(error: InputError) -> InputError:
    """The same complaint without the fields of a file that nobody edits; others are returned as they are."""
    if error.where.startswith("[gauge]"):
        face = "upper" if "upper" in error.where else "lower"
        todo = "exchange the two regions" if error.todo.startswith("exchange") else error.todo
        what = error.what.replace("polygon", "region")
        return InputError(what, where=f"region of the {face} face", todo=todo)
    if "rig.toml" in error.todo:
        return InputError(error.what, where=error.where, todo="scan both faces, or draw a region on each of them")
    return error
