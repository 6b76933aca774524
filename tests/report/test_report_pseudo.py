"""A report in the pseudo-language: what bypasses the catalogues stands out, for it has no brackets round it."""

import io
import re

import pytest
from pypdf import PdfReader

from core.report.pdf import build_report
from core.translations import PSEUDO

from .inspection_samples import whole_content

NAMES = re.compile(
    r"[\w.\-/]+\.(png|json|toml)|[0-9a-f]{6,}…?|TR-[0-9A-F-]+|Trisect|[\w\-]*\d[\w\-]*|UTC|mm|px|µm|°C|rms|RMSE|Cgk?|ndc|"
    r"frame|scan|camera|planes|pose|view|reference|rig|off"
)
"""Names of files and of studies, numbers, units and symbols: the same in every language."""


@pytest.fixture(scope="module")
def content():
    """Without what people wrote in their own words."""
    return whole_content(language=PSEUDO)


def outside_brackets(text):
    """What stands outside all brackets."""
    depth, found = 0, []
    for character in text:
        depth += (character == "⟦") - (character == "⟧")
        if depth == 0 and character != "⟧":
            found.append(character)
    return "".join(found)


def spoken(content):
    """The words that the content itself brings: names that people gave, and texts of older files."""
    texts = [
        content.part,
        content.serial,
        content.laboratory,
        content.operator,
        content.customer,
        content.remarks,
        content.method,
    ]
    texts += [content.template.name, *content.template.address, content.template.footer, content.template.text]
    texts += [*content.template.signatures, *map(str, content.notes), *content.rig.keys(), *content.rig.values()]
    texts += [str(value) for pair in content.settings.items() for value in pair]
    texts += [one.name for one in content.inspected] + [str(one.rule) for one in content.inspected]
    texts += [str(note) for one in content.inspected for note in one.notes]
    texts += [str(frame.reason) for frame in content.frames if not frame.used] + [str(content.fan.verdict)]
    texts += [str(view.reason) for view in content.camera.views] + [str(pose.reason) for pose in content.fan.poses]
    texts += [str(row.source) for one in content.inspected for row in one.budget] + [
        one.name for one in content.deviations
    ]
    texts += [one.name for one in content.studies]
    return {word.casefold() for text in texts for word in re.findall(r"[^\W\d_]+", text)}


def test_every_text_of_a_report_comes_from_the_catalogues(content):
    pages = [page.extract_text() for page in PdfReader(io.BytesIO(build_report(content))).pages]
    text = outside_brackets(" ".join(pages).replace("\u00a0", " "))
    left = {word.casefold() for word in re.findall(r"[^\W\d_]{3,}", NAMES.sub(" ", text))}
    assert left - spoken(content) == set()
