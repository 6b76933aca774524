"""The program's own text as hashes: the same from source and frozen, and never of nothing."""

import pytest

from core import compiled, sources
from core.errors import InputError

ROOMS = ("acquire", "image", "scan")


@pytest.fixture
def frozen(tmp_path, monkeypatch):
    """A program without source files; returns the file that is written as it is built, not yet there."""
    monkeypatch.setattr(sources, "BUILT", tmp_path / "saved_code" / "sources.json")
    monkeypatch.setattr(sources, "PACKAGE", tmp_path)
    sources.BUILT.parent.mkdir()
    sources.text_hash.cache_clear()
    yield sources.BUILT
    sources.text_hash.cache_clear()


def test_a_frozen_program_finds_what_the_same_version_from_source_has_made(tmp_path, monkeypatch, request):
    from_source = sources.text_hash(ROOMS), compiled._key(compiled._FILES)
    kept = sources.to_be_built(compiled._FILES)
    built = request.getfixturevalue("frozen")
    built.write_text(kept)
    assert (sources.text_hash(ROOMS), compiled._key({})) == from_source
    assert sources.text_hash(("image",)) != from_source[0]


@pytest.mark.parametrize("kept", [None, "", "{}", "[]", '{"files": {}, "compiled": {}}'])
def test_without_sources_and_without_what_is_known_of_them_nothing_is_hashed(frozen, kept):
    if kept is not None:
        frozen.write_text(kept)
    for hashed in (lambda: compiled._key({}), lambda: sources.text_hash(ROOMS)):
        with pytest.raises(InputError, match=r"the program is not whole.*; install it anew"):
            hashed()


def test_a_room_whose_text_is_not_known_is_no_room(frozen):
    frozen.write_text('{"files": {"image/stripes.py": "00"}, "compiled": {"image/stripes.py": "00"}}')
    sources.text_hash(("image",))
    with pytest.raises(InputError, match="not whole"):
        sources.text_hash(("scan",))
