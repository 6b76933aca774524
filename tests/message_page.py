"""`make messages`: the manual's page of every error and warning, by code, with its text and what to do.

Texts come from the calls that tell them and from the table of findings; what to do is the advice that stands beside an
error in its call. What is explained at more length is on the page on troubleshooting, which people write.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from fnmatch import fnmatchcase
from functools import cache
from itertools import groupby
from string import Formatter

from core.findings.table import all_findings
from tests.code import ROOT, modules, nodes, syntax_tree
from tests.translations import CODED, all_texts, called, literals

MANUAL = ROOT / "resources" / "manual"
PAGE = MANUAL / "messages.md"

NAMES = (
    "advice.*", "*.advice_*", "*.rule_*", "*.cause_*", "input.*",
    "artefact.passed", "check.passed", "readjust.undone", "target.sizes_agree",
    "camera.downwards", "camera.inwards", "camera.outwards", "camera.upwards", "camera.to_the_*", "camera.none",
    "camera.only", "camera.of_view", "camera.nameless_view",
    "camera.view_number", "camera.two_reasons",
    "cause.*", "comparison.as_measured", "comparison.best_fit", "comparison.by_frame", "doubt.*",
    "study.doubted_result",
    "fan.angle_with_sd", "fan.bent_*", "fan.constrained_used", "fan.free_*_used", "fan.of_pose", "fan.one_axis*",
    "fan.pose_and_reason", "fan.pose_reason_and_distance", "fan.suits", "fan.used_as_asked", "fan.verdict",
    "feature.where*", "feature.compared_with_master", "feature.stated_at_20",
    "form.above", "form.below", "form.the_*", "form.too_*", "gauge.*er_region", "gauge.where_*", "gauge.without_*",
    "import.by_*", "import.pairs_by_*", "import.no_off", "import.order_and_pairs", "import.pictures", "import.poses",
    "live.marked", "live.reason", "live.saving", "live.taken", "live.set_*", "live.start_sweeping",
    "live.take_reference",
    "picture.bottom", "picture.left*", "picture.lower_*", "picture.middle", "picture.right*", "picture.top",
    "picture.upper_*", "plan.best_change", "plan.bound_*", "plan.change_*", "plan.contrast", "plan.degrees",
    "plan.grey_levels", "plan.map_title", "plan.millimetres", "plan.number", "profile.mean_of",
    "report.characteristics", "report.crossings", "report.days", "report.hours", "report.inputs",
    "report.note_of_result", "report.points*", "report.remarks",
    "scan.between_frames", "scan.brighter", "scan.darker", "scan.everything", "scan.the_part", "scan.farther",
    "scan.nearer", "scan.earlier_sweep", "scan.fan_line", "scan.crosses", "scan.crossing_counts", "scan.crossing_good",
    "scan.check_age", "scan.check_exposure", "scan.check_focus", "scan.check_fresh", "scan.check_lines",
    "scan.check_reference", "scan.scale_fixed", "scan.stripe_width", "set.channel_blue*", "set.channel_green*",
    "set.channel_red*", "source.aravis*", "source.basler*", "source.device", "source.first_camera", "source.folder",
    "source.folder_help", "source.folder_usual", "source.genicam*", "source.opencv*", "source.region", "source.replay*",
    "source.scene*", "source.simulated", "source.simulated_help", "study.after_the_guideline", "study.flatness_error",
    "study.its_columns", "study.nearest_column", "study.probing_*", "study.sphere_spacing", "study.tip_*",
    "surface.where_*",
    "target.board", "target.poses", "target.print_to_size", "target.target", "target.views", "told.*",
    "window.another_*", "window.elsewhere", "window.profile_tilt", "window.results_folder",
)  # fmt: skip
"""Codes of what is neither error nor warning: advice, which stands beside its error; names, numbers, places, and what
went well."""

HEAD = """# Every error and warning, by code

Written by `make messages` from the program itself: the English text, its values in {braces}, and what the program says
to do about it. Where nothing stands there, the text says it, or what stands above the table does. Notes of results have
a weight, by which they are ordered and coloured, and an effect on what rests on the result: none, a larger U, no proof
of conformity, or no result. *Usual cause* leads
to the page on troubleshooting.
"""

Named = dict[str, list[tuple[str, str]]]
"""By the name of a constant or of a function: code and text of each message that it may be."""

RAISED = ("InputError", "WrongValue", "TargetNotFound", "Unplugged")
"""Errors that have a message; others are called with `todo`."""


def explained() -> dict[str, str]:
    """By the code: what helps, as the page on troubleshooting says beside the usual cause."""
    coded = r"`([a-z_0-9]+\.[a-z_0-9]+)`"
    return {code: helps for first, _, helps in _rows() for code in re.findall(coded, first)}


def rooms() -> dict[str, tuple[str, str]]:
    """By the first word of a code: what its messages are about, and what helps where they do not say; of that page."""
    return {first.strip("`"): (about, helps) for first, about, helps in _rows() if re.fullmatch("`[a-z]+`", first)}


def _rows() -> list[tuple[str, ...]]:
    page = (MANUAL / "troubleshooting.md").read_text(encoding="utf-8")
    return re.findall(r"^\| (.*?) \| (.*?) \| (.*?) \|$", page, re.MULTILINE)


def codes() -> list[str]:
    """The codes of all errors and warnings, in order."""
    return sorted({text.code for text in all_texts() if text.code and not is_name(text.code)})


def page() -> str:
    """The page as Markdown."""
    texts = {text.code: text.english[-1] for text in all_texts()}
    advice, helps, about_rooms = errors(), explained(), rooms()
    parts = [HEAD]
    for room, within in groupby(codes(), lambda code: code.partition(".")[0]):
        about, general = about_rooms[room]
        general = f"{general[0].upper()}{general[1:]}"
        parts.append(
            f"## {room}: {about}\n\n{general}.\n\n| code | text | weight, effect | what to do |\n|---|---|---|---|"
        )
        for code in within:
            todo = ["; or: ".join(map(_shown, advice.get(code, ())))]
            todo += [f"{helps[code]} ([usual cause](troubleshooting.md))"] if code in helps else []
            parts.append(f"| `{code}` | {_shown(texts[code])} | {_weighed(code)} | {'; '.join(filter(None, todo))} |")
        parts.append("")
    return "\n".join(parts)


def _weighed(code: str) -> str:
    """How grave a note is and what it does to what rests on the result, by the table of findings; '' of an error."""
    row = all_findings().get(code)
    return "" if row is None else f"{row.weight.name.lower()}, {row.effect}"


def _shown(text: str) -> str:
    """A text with the names of its places alone, as a cell of a table."""
    pieces = [f"{lead}{{{place}}}" if place is not None else lead for lead, place, _, _ in Formatter().parse(text)]
    return re.sub(r"([|*<`\\])", r"\\\1", "".join(pieces)).replace("\n", " ")


def is_name(code: str) -> bool:
    """Whether a code is of neither error nor warning."""
    return any(fnmatchcase(code, pattern) for pattern in NAMES)


@cache
def errors() -> dict[str, list[str]]:
    """By the code of an error, what the calls that tell it say to do."""
    shared: Named = {}
    for path in modules("core", "workbench", "trisect"):
        for name, known in _named(syntax_tree(path).body).items():
            shared.setdefault(name, []).extend(known)
    found: dict[str, list[str]] = {}
    for path in modules("core", "workbench", "trisect"):
        for code, advice in errors_of(nodes(path), shared):
            said = found.setdefault(code, [])
            said += [one for one in advice if one not in said]
    return found


def errors_of(of_module: Sequence[ast.AST], shared: Named | None = None) -> Iterator[tuple[str, list[str]]]:
    """The code of each error that a module tells, given all its nodes, and what it says to do there.

    `shared`: constants of all modules.
    """
    here = {one.asname or one.name for node in of_module if isinstance(node, ast.ImportFrom) for one in node.names}
    named = {name: known for name, known in (shared or {}).items() if name.removesuffix("()") in here}
    for name, known in _named(of_module).items():
        named[name] = [*named.get(name, ()), *known]
    for node in of_module:
        if isinstance(node, ast.Call) and node.args:
            todo = [keyword.value for keyword in node.keywords if keyword.arg == "todo"]
            if todo or called(node) in RAISED:
                advice = [text for one in todo for _, text in _messages(one, named)]
                yield from ((code, advice) for code, _ in _messages(node.args[0], named))


def _named(nodes: Iterable[ast.AST]) -> Named:
    """Code and text of the messages that names stand for, and that functions, by name with "()", give back."""
    found: Named = {}
    for node in nodes:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            told = _messages(node.value, {})
            for target in (node.targets if isinstance(node, ast.Assign) else [node.target]) if told else ():
                found.setdefault(ast.unparse(target), []).extend(told)
        elif isinstance(node, ast.FunctionDef):
            given = [one.value for one in ast.walk(node) if isinstance(one, ast.Return) and one.value is not None]
            found.setdefault(f"{node.name}()", []).extend(text for one in given for text in _messages(one, {}))
    return found


def _messages(node: ast.expr, named: Named) -> list[tuple[str, str]]:
    """Code and text of what an expression can tell, not of what stands within a message's places."""
    if isinstance(node, ast.IfExp):
        return _messages(node.body, named) + _messages(node.orelse, named)
    if isinstance(node, ast.BoolOp):
        return [one for value in node.values for one in _messages(value, named)]
    if isinstance(node, ast.Call) and called(node) in CODED:
        code, text = node.args[0], node.args[CODED[called(node)]][-1]
        told = [str(one.value) for one in (code, text) if isinstance(one, ast.Constant)]
        return [(told[0], told[1])] if len(told) == 2 else []
    if isinstance(node, ast.Call) and called(node) == "note_of":
        return [(code, all_findings()[code].many or all_findings()[code].text) for code in literals(node.args[0])]
    if isinstance(node, ast.Call):
        return named.get(f"{called(node)}()", [])
    return named.get(ast.unparse(node), []) if named else []


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
