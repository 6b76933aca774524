"""What excludes a picture, in words and back from the words of a file."""

import pytest

from core.files.arrays_file import pack_messages, unpack_messages
from core.image.exclusion import Exclusion, known_exclusion
from core.messages import plain


@pytest.mark.parametrize("one", Exclusion)
def test_what_excludes_is_known_again_from_the_words_in_a_file(one):
    (read,) = unpack_messages(pack_messages([one.message]))
    assert known_exclusion(read) is one
    assert known_exclusion(plain(str(one.message))) is one, "older files hold bare sentences"


def test_other_words_stay_as_they_are():
    assert known_exclusion(plain("the picture ends early")) == plain("the picture ends early")
    assert known_exclusion(None) is None
