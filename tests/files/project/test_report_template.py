import io

import pytest
from PIL import Image

from core.errors import InputError
from core.files.project.report_template import read_report_template
from core.report.template import ReportTemplate

WHOLE = """
name = "Werkzeugbau Süd GmbH"
address = ["Messraum 2", "70565 Stuttgart"]
logo = "logo.png"
accent = "#702030"
footer = "HRB 12345"
text = "Results refer to the item measured only."
signatures = ["M. Jørgensen", "Dr. A. Brandt"]
without = ["frame", "inputs"]
paper = "Letter"
language = "de"
"""


def logo():
    data = io.BytesIO()
    Image.new("RGB", (60, 20), "red").save(data, "PNG")
    return data.getvalue()


def read(folder, text):
    (folder / "template.toml").write_text(text, encoding="utf-8")
    return read_report_template(folder / "template.toml")


def test_every_key_of_a_template_is_read(tmp_path):
    (tmp_path / "logo.png").write_bytes(logo())
    assert read(tmp_path, WHOLE) == ReportTemplate(
        name="Werkzeugbau Süd GmbH",
        address=("Messraum 2", "70565 Stuttgart"),
        logo=logo(),
        accent="#702030",
        footer="HRB 12345",
        text="Results refer to the item measured only.",
        signatures=("M. Jørgensen", "Dr. A. Brandt"),
        without=frozenset({"frame", "inputs"}),
        paper="Letter",
        language="de",
    )


def test_every_key_may_be_left_out(tmp_path):
    assert read(tmp_path, "") == ReportTemplate()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('nane = "X"', r"nane is an unknown key \(did you mean name\?\)"),
        ('accent = "red"', 'accent is "red", not a colour as "#14586E"'),
        ('paper = "A3"', 'paper is "A3", not "A4" or "Letter"'),
        ('language = "fr"', 'language is "fr", not "en" or "de"'),
        ('without = ["result"]', 'there is no section "result" to leave out; choose among surface'),
        ('logo = "missing.png"', "missing.png"),
        ('logo = "words.png"', "no PNG or JPEG picture"),
        ("name = ", "no valid TOML"),
        ("signatures = [1]", "signatures"),
    ],
)
def test_what_is_wrong_is_told_with_file_and_key(tmp_path, text, said):
    (tmp_path / "words.png").write_text("words")
    with pytest.raises(InputError, match=said):
        read(tmp_path, text)


def test_a_picture_cut_short_is_no_logo(tmp_path):
    (tmp_path / "logo.png").write_bytes(logo()[:-30])
    with pytest.raises(InputError, match="no PNG or JPEG picture"):
        read(tmp_path, 'logo = "logo.png"')


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"address = {['x'] * 5000}", "address is .*, not a list of at most 10 lines"),
        (f"address = ['{'x' * 5000}']", "address must be a list of at most 10 lines of at most 200"),
        (f"text = '{'x ' * 50_000}'", "not a text of at most 5000 characters"),
        ("logo = '/dev/zero'", "this is a pipe, a socket or a device"),
    ],
)
def test_a_template_that_no_page_holds_is_refused(tmp_path, text, said):
    (tmp_path / "t.toml").write_text(text)
    with pytest.raises(InputError, match=said):
        read_report_template(tmp_path / "t.toml")
