"""What a refusal owes to a user: the file, the line where there is one, one short sentence, and an untouched folder."""

import re
from contextlib import contextmanager

import pytest

from hypernode.dic.errors import DicError

#: Longest message, without the folder.
LONGEST = 400


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@contextmanager
def refused(path, words, line=True):
    """The block ends in a DicError that names the file, and its line, in one sentence with these words.

    ``line`` is None where some formats have one and others not.
    """
    before = contents(path.parent)
    with pytest.raises(DicError) as found:
        yield
    message = str(found.value)
    where = re.escape(str(path)) + {True: r":\d+: ", False: r": ", None: r"(:\d+)?: "}[line]
    assert re.match(where, message), message
    assert re.search(words, message), message
    assert len(message.replace(f"{path.parent}/", "")) <= LONGEST, message
    assert "\n" not in message and not re.search(r"[.!?] +[A-Z]", message), message
    assert contents(path.parent) == before
