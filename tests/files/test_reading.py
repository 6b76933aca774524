import pytest

from core.errors import InputError
from core.files.reading import read_bytes, read_text


@pytest.mark.parametrize("read", [read_bytes, read_text])
def test_a_folder_where_a_file_is_wanted_is_called_one(tmp_path, read):
    with pytest.raises(InputError, match=f"{tmp_path.name}: this is a folder; put a file there"):
        read(tmp_path)


def test_a_text_in_another_encoding_is_told_with_the_place_and_what_helps(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_bytes("größe = 1".encode("latin-1"))
    with pytest.raises(InputError, match=r"rig\.toml: this is no UTF-8 text: byte 3 is in no letter; save it as UTF-8"):
        read_text(path)
