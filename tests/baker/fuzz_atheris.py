"""Fuzz what reads scans by its coverage: `python -m tests.baker.fuzz_atheris "ply ascii"`.

    KIND           of tests/baker/sound_files.py: "pcd binary", "csv", "times", "corrections", ...
    --minutes M    how long
    --seed S       another seed takes other ways
    --keep FOLDER  where a file that shows a failure is kept; here if not given

Where `fuzz_scans` draws damages at random, atheris (libFuzzer) follows those that reach new lines
of our readers. Each file is read, or refused in one sentence, in 20 seconds and 2 GB. Stops at the
first that isn't, with its traceback. Needs the extra `fuzz`, for Linux, and says so without it.
"""

from __future__ import annotations

import sys
import tempfile
from importlib import import_module
from pathlib import Path

from tests.gclip.fuzz_atheris import fuzz, is_missing, parser

INSTRUMENTED = ["baker.scans", "corrections", "player.view", "player.window.settings"]
MODULES = ["baker.scans.read", "corrections", "player.window.settings"]
MODULES += [f"baker.scans.formats.{name}" for name in ("ply", "pcd", "text", "arrays")]


def main() -> int:
    words = parser(__doc__)
    words.add_argument("kind", metavar="KIND")
    asked = words.parse_args()
    if is_missing():
        return 2
    import atheris

    with atheris.instrument_imports(include=INSTRUMENTED):
        for name in (*MODULES, "player.view.camera_animation", "baker.scans.rgbd.camera"):
            import_module(name)

    from tests.baker.hostile_files import DAMAGES, File, check_content

    with tempfile.TemporaryDirectory() as folder:
        damaged = [File(asked.kind, ((damage, asked.seed),)).content() for damage in DAMAGES]
        place = Path(folder, "case")
        place.mkdir()

        def look(data: bytes) -> None:
            check_content(asked.kind, data, place)

        fuzz(asked, Path(folder), [File(asked.kind, ()).content(), *damaged], look)
    return 0


if __name__ == "__main__":
    sys.exit(main())
