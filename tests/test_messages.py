import json
import pickle
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.messages import (
    ENGLISH,
    Command,
    Field,
    Language,
    Message,
    as_json,
    from_json,
    label,
    plain,
    plural_message,
    unparted,
)
from core.translations import language

GERMAN = Language(
    "de",
    {
        "fan.bow": "Wölbung {bow_mm:.2f} mm",
        "camera.left_out": ("{n} Ansicht fehlt", "{n} Ansichten fehlen"),
        "camera.blurred": "unscharf",
    },
    {"Camera": "Kamera"},
    decimal=",",
    conjunction="{0} und {1}",
)


def bow(mm: float = -0.4):
    return Message("fan.bow", "the bow is {bow_mm:.2f} mm", bow_mm=mm)


def test_the_english_text_stands_in_the_message():
    assert str(bow()) == "the bow is −0.40 mm"


def test_another_language_writes_text_and_numbers_in_its_own_way():
    assert GERMAN(bow()) == "Wölbung −0,40 mm"


def test_a_language_that_lacks_a_message_tells_it_in_english_with_its_own_numbers():
    assert GERMAN(Message("fan.other", "by {x:.1f}", x=1.5)) == "by 1,5"


@pytest.mark.parametrize(
    ("n", "english", "german"), [(1, "1 view is out", "1 Ansicht fehlt"), (3, "3 views are out", "3 Ansichten fehlen")]
)
def test_numbers_choose_the_plural_form(n, english, german):
    message = plural_message("camera.left_out", "{n} view is out", "{n} views are out", n=n)
    assert (str(message), GERMAN(message)) == (english, german)


def test_a_message_within_a_message_is_told_in_the_same_language():
    inner = Message("camera.blurred", "blurred")
    assert GERMAN(Message("x.y", "{view}: {reason}", view="view01", reason=inner)) == "view01: unscharf"


@pytest.mark.parametrize(
    ("text", "said"), [("{names}", "a, b, c"), ("{names:and}", "a, b and c"), ("{names:;}", "a; b; c")]
)
def test_several_names_are_joined_as_the_text_says(text, said):
    assert str(Message("x.y", text, names=["a", "b", "c"])) == said


def test_chinese_names_are_joined_by_their_own_signs():
    chinese = language("zh_CN")
    assert [chinese.joined(["一", "二", "三"], how) for how in ("", "and", ";")] == [
        "一、二、三",
        "一、二和三",
        "一；二；三",
    ]


def test_no_line_break_parts_a_number_from_its_unit():
    assert unparted("U = 0.02 mm (k = 2)") == "U\u00a0=\u00a00.02\u00a0mm (k\u00a0=\u00a02)"
    assert unparted("通常 50 次") == "通常 50\u00a0次"
    assert unparted("5.002° ± 0.003° free") == "5.002°\u00a0±\u00a00.003° free"
    assert unparted("50.002 mm ± 0.020 mm") == "50.002\u00a0mm ±\u00a00.020\u00a0mm"  # where it is long
    assert unparted("by ISO 14253-1") == "by ISO\u00a014253-1"
    assert unparted("0.02 mm of 20 °C, 5 % and 3 places") == "0.02\u00a0mm of 20\u00a0°C, 5\u00a0% and 3 places"
    assert unparted("by ISO 14253-1 at most") == "by ISO\u00a014253-1 at most"


def test_fixed_words_in_a_message_are_told_in_the_readers_language_also_after_a_file():
    message = Message("x.y", "the {thing} is off", thing=label("Camera"))
    assert str(message) == "the Camera is off"
    german = Language("de", {"x.y": "{thing} ist aus"}, {"Camera": "Kamera"})
    kept = from_json(json.loads(json.dumps(as_json(message))))
    assert [german(one) for one in (message, kept, pickle.loads(pickle.dumps(message)))] == ["Kamera ist aus"] * 3


def test_a_message_that_begins_a_sentence_has_a_capital():
    reason = Message("camera.blurred", "blurred")
    assert str(Message("x.y", "{reason:capital}.", reason=reason)) == "Blurred."
    assert GERMAN(Message("x.y", "{reason:capital}.", reason=reason)) == "Unscharf."


def test_a_field_and_a_command_are_told_as_the_reader_knows_them():
    message = Message(
        "x.y", "check {field}{how}", field=Field("camera_target.inner_corners"), how=Command("trisect run")
    )
    window = Language(fields={"camera_target.inner_corners": "columns and rows of the target"}, commands=False)
    assert str(message) == "check inner_corners in rig.toml: trisect run"
    assert window(message) == "check columns and rows of the target"


def test_a_file_keeps_code_values_and_english_text_and_gives_the_message_back():
    inner = Message("camera.blurred", "blurred")
    message = Message(
        "x.y", "{a} {b:.2f} {c} {d}", a=Path("x"), b=np.float64(2.5), c=inner, d=[Field("k"), Command("t")]
    )
    kept = as_json(message)
    assert (kept["code"], kept["text"], kept["values"]["b"]) == ("x.y", "x 2.50 blurred k in rig.toml, : t", 2.5)
    back = from_json(kept)
    assert str(back) == str(message)
    assert dict(back.values) == dict(message.values)
    assert as_json(back) == kept
    assert Language("de", {"x.y": "{c}, {b:.1f}", "camera.blurred": "unscharf"}, decimal=",")(back) == "unscharf, 2,5"


def test_a_plural_message_from_a_file_is_told_in_another_language():
    kept = as_json(plural_message("camera.left_out", "{n} view is out", "{n} views are out", n=2))
    assert GERMAN(from_json(kept)) == "2 Ansichten fehlen"


def test_somebodys_own_words_are_told_as_they_are():
    assert ENGLISH(plain("50 {mm} [/b]")) == GERMAN(from_json("50 {mm} [/b]")) == "50 {mm} [/b]"


def test_messages_and_errors_travel_between_processes():
    message = plural_message("camera.left_out", "{n} view is out", "{n} views are out", n=2)
    error = InputError(message, where=Path("rig.toml"), todo=bow())
    back = pickle.loads(pickle.dumps(error))
    assert (str(back), back.code, back.what) == (str(error), "camera.left_out", message)
    assert error.text_in(GERMAN) == "rig.toml: 2 Ansichten fehlen; Wölbung −0,40 mm."


def test_a_message_cannot_be_changed():
    with pytest.raises(AttributeError):
        bow().code = "other"


def test_fixed_words_have_no_code():
    assert (ENGLISH.label("Camera"), GERMAN.label("Camera"), GERMAN.label("Fan")) == ("Camera", "Kamera", "Fan")


NOON = datetime(2026, 3, 4, 12, 5, 6, tzinfo=timezone(timedelta(hours=8)))


def test_a_time_in_a_message_is_told_as_the_reader_writes_it_also_after_a_file():
    message = Message("x.y", "checked on {at}", at=NOON)
    assert str(message) == "checked on 2026-03-04 12:05"
    kept = from_json(json.loads(json.dumps(as_json(message))))
    assert kept == message
    german = replace(language("de"), messages={"x.y": "geprüft am {at}"})
    chinese = replace(language("zh_CN"), messages={"x.y": "检查于 {at}"})
    assert german(kept) == "geprüft am 04.03.2026, 12:05"
    assert chinese(kept) == "检查于 2026年3月4日 12:05"


def test_seconds_are_written_where_they_are_asked_for():
    told = [one.time(NOON, seconds=True) for one in (ENGLISH, language("de"))]
    assert told == ["2026-03-04 12:05:06", "04.03.2026, 12:05:06"]


def test_nobody_writes_a_date_for_people_in_a_way_of_their_own():
    root = Path(__file__).parents[1]
    found = [
        str(path.relative_to(root))
        for folder in ("core", "workbench", "trisect")
        for path in sorted((root / folder).rglob("*.py"))
        if "%Y-%m-%d" in path.read_text(encoding="utf-8")
    ]
    assert found == ["core/files/exchange/xlsx.py", "core/messages.py"]  # a stamp in a file, and English


def test_a_message_of_an_older_file_that_lacks_a_value_of_todays_text_is_told_as_it_was():
    kept = from_json({"code": "camera.off", "text": "off by 0.2 px", "values": {"px": 0.2}})
    german = replace(ENGLISH, messages={"camera.off": "um {px:.1f} px ({mm:.2f} mm) daneben"})
    assert german(kept) == "off by 0.2 px"
    with pytest.raises(KeyError):
        german(Message("camera.off", "off by {px} px ({mm} mm)", px=0.2))
