"""What is printed can give no orders to a terminal."""

import subprocess
import sys
from pathlib import Path

import pytest

from gclip.text import printable


def test_printable_shows_what_people_write_and_nothing_else() -> None:
    joined = "می\N{ZERO WIDTH NON-JOINER}روم"
    spaced = ("葉\N{IDEOGRAPHIC SPACE}1", "a\N{NO-BREAK SPACE}b")
    for plain in ("", "leaf 3", "Blatt №5 – größer", "🌱", joined, *spaced):
        assert printable(plain) == plain
    assert printable("a\x1b[2Jb\nc\u202ed\ud800e\u2028") == "a\ufffd[2Jb\ufffdc\ufffdd\ufffde\ufffd"
    assert printable("abcdef", 4) == "abc…"
    assert printable("abcd", 4) == "abcd"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_loses_text_and_nothing_else() -> None:
    code = (
        "import sys; from gclip.text import Lossy\n"
        "for _ in range(3): Lossy(sys.stderr).write('lost\\n')\n"
        "print('lost too', file=sys.stderr); print('done')"
    )
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=full)
    assert (done.returncode, done.stdout) == (0, b"done\n")
