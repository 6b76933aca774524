"""Films are read frame by frame: what they hold, what their coding has lost, and what is wrong with broken ones."""

import cv2
import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files import film as module
from core.files.compression import FilmLoss, compression_of
from core.files.film import film_picture, film_pictures, film_png, is_film, read_film
from core.files.jpeg import compression_by
from core.files.pictures import decode_colours
from tests.films import say_longer, sweep, write_film

KINDS = [
    *(
        ("a.avi", "FFV1"),
        ("a.mkv", "FFV1"),
        ("a.avi", "MJPG"),
        ("a.mp4", "mp4v"),
        ("a.mov", "mp4v"),
        ("a.webm", "VP80"),
    ),
    *(("a.gif", ""), ("a.apng", ""), ("a.png", ""), ("a.webp", "")),
]


@pytest.mark.parametrize(("name", "coding"), KINDS)
def test_every_frame_of_every_kind_is_read_with_its_number_and_time(tmp_path, name, coding):
    path = write_film(tmp_path / name, sweep(), coding)
    assert is_film(path)
    film, sample = read_film(path)
    assert (film.size, film.doubled, film.grey) == ((96, 64), 0, False)
    assert [frame.number for frame in film.frames] == list(range(12))
    assert [frame.time_s for frame in film.frames] == pytest.approx([n / 10 for n in range(12)], abs=0.002)
    shown = [picture for _, picture in film_pictures(film)]
    assert len(shown) == len(sample) == 12
    for number in (0, 7):
        assert np.abs(shown[number].astype(int) - sweep()[number]).mean() < 12
        assert np.array_equal(film_picture(path, number), shown[number])


@pytest.mark.parametrize(("name", "coding"), [("a.avi", "FFV1"), ("a.mkv", "FFV1"), ("a.apng", "")])
def test_a_film_without_loss_gives_the_very_pixels(tmp_path, name, coding):
    film, _ = read_film(write_film(tmp_path / name, sweep(), coding))
    assert film.loss is None
    assert all(np.array_equal(a, b) for (_, a), b in zip(film_pictures(film), sweep(), strict=True))


def test_frames_that_are_the_one_before_again_are_kept_once(tmp_path):
    a, b, c = sweep(3)
    film, _ = read_film(write_film(tmp_path / "a.avi", [a, a, b, b, b, c, a]))
    assert [frame.number for frame in film.frames] == [0, 2, 5, 6]
    assert film.doubled == 3
    assert all(np.array_equal(x, y) for (_, x), y in zip(film_pictures(film), [a, b, c, a], strict=True))


def test_a_grey_film_gives_grey_pictures(tmp_path):
    grey = [np.repeat(picture[:, :, :1], 3, axis=2) for picture in sweep(4)]
    film, _ = read_film(write_film(tmp_path / "a.avi", grey))
    assert film.grey
    assert [picture.shape for _, picture in film_pictures(film)] == [(64, 96)] * 4


def test_a_film_of_jpegs_has_lost_what_their_tables_say(tmp_path):
    path = write_film(tmp_path / "a.avi", sweep(), "MJPG")
    data = path.read_bytes()
    film, _ = read_film(path)
    assert film.loss is not None and not film.loss.assumed
    for channel in (None, "red", "red-green"):
        told = compression_of(data[data.index(b"\xff\xd8\xff") :], channel)
        assert told.grey > 0
        assert compression_by(film.loss.components, channel) == told


def test_of_a_coding_that_does_not_tell_a_loss_is_assumed(tmp_path):
    film, _ = read_film(write_film(tmp_path / "a.mp4", sweep(), "mp4v"))
    assert film.loss is not None and film.loss.assumed
    assert compression_by(film.loss.components).grey == pytest.approx(20 / 12**0.5)


def test_a_palette_loses_what_its_colours_lie_apart(tmp_path):
    ramp = np.broadcast_to(np.arange(0, 256, 8, np.uint8)[:, None, None], (32, 40, 3)).copy()
    ramps = [np.roll(ramp, n, axis=1) + np.uint8(n) for n in range(3)]
    film, _ = read_film(write_film(tmp_path / "a.gif", ramps, ""))
    assert film.loss == FilmLoss(((8.0, 1.0),))


def test_a_frame_says_what_its_film_had_lost(tmp_path):
    film, _ = read_film(write_film(tmp_path / "a.avi", sweep(), "MJPG"))
    frame, picture = next(film_pictures(film))
    png = film_png(picture, film)
    assert frame.number == 0
    assert np.array_equal(decode_colours(png, tmp_path / "a.png"), picture)
    assert compression_of(png, "red") == compression_by(film.loss.components, "red")
    assert compression_of(png[:300]) == compression_by(film.loss.components)


@pytest.mark.parametrize("told", [b"", b"{}", b"[1]", b'{"components": [[1]], "assumed": 1}', b"[" * 9000])
def test_a_damaged_word_on_the_loss_is_none(tmp_path, told):
    png = bytes(cv2.imencode(".png", sweep(1)[0])[1])
    body = b"tEXtFilm compression\0" + told
    assert compression_of(png[:33] + (len(body) - 4).to_bytes(4, "big") + body + b"0000" + png[33:]).grey == 0


@pytest.mark.parametrize(("name", "coding"), KINDS)
@pytest.mark.parametrize("share", [0.02, 0.5, 0.98])
def test_a_film_that_was_cut_off_is_refused_with_how_many_frames_can_be_read(tmp_path, name, coding, share):
    path = write_film(tmp_path / name, sweep(), coding)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    with pytest.raises(InputError, match=r"ends early or is damaged: \d+ |no film, or one of a coding") as caught:
        read_film(path)
    told = caught.value.what.values
    assert told.get("read", 0) < 12
    if share > 0.9:
        assert caught.value.what.code.startswith("film.ends_early")


@pytest.mark.parametrize(
    "data", [b"", b"RIFF", b"RIFF\xff\xff\xff\xffAVI LIST", b"GIF89a", b"\0\0\0\x18ftypmp42", b"#EXTM3U"]
)
def test_what_is_no_film_is_told_in_a_sentence(tmp_path, data):
    path = tmp_path / "a.avi"
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"no film|ends early"):
        read_film(path)


def test_a_still_picture_is_no_film(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), sweep(1)[0])
    (tmp_path / ".a.avi").write_bytes(b"")
    assert not is_film(tmp_path / "a.png")
    assert not is_film(tmp_path / ".a.avi")
    assert not is_film(tmp_path / "gone.png")


def test_a_film_that_is_too_long_is_refused_before_it_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "FILM_FRAMES", 5)
    with pytest.raises(InputError, match="more than 5 frames"):
        read_film(write_film(tmp_path / "a.avi", sweep()))


def test_a_whole_film_whose_sound_is_longer_than_its_frames_is_read(tmp_path):
    path = say_longer(write_film(tmp_path / "a.mkv", sweep(60), "FFV1", rate=30.0), 0.2)
    film, _ = read_film(path)
    assert (len(film.frames), film.missing) == (60, 6)
    plain = write_film(tmp_path / "b.mkv", sweep(60), "FFV1", rate=30.0)
    assert read_film(plain)[0].missing == 0


def test_a_film_that_lacks_more_than_a_sound_track_explains_is_refused(tmp_path):
    path = say_longer(write_film(tmp_path / "a.mkv", sweep(60), "FFV1", rate=30.0), 1.2)
    with pytest.raises(InputError, match=r"60 of its 96 frames can be read"):
        read_film(path)


def test_the_count_of_a_film_that_lists_its_frames_is_binding(tmp_path):
    path = write_film(tmp_path / "a.avi", sweep(60), "FFV1", rate=30.0)
    data = bytearray(path.read_bytes())
    at = data.index(b"strh") + 8 + 32  # dwLength of the stream's head
    assert int.from_bytes(data[at : at + 4], "little") == 60
    data[at : at + 4] = (66).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"60 of its 66 frames can be read"):
        read_film(path)


def test_reading_can_be_cancelled(tmp_path):
    def after_three(step: str, done: int, total: int) -> None:
        if done == 3:
            raise Cancelled

    with pytest.raises(Cancelled):
        read_film(write_film(tmp_path / "a.avi", sweep()), after_three)
