"""Fuzz `gclip.open` by its coverage: `python -m tests.gclip.fuzz_atheris --minutes 10`.

    --minutes M    how long
    --seed S       another seed takes other ways
    --keep FOLDER  where a file that shows a failure is kept; here if not given

Where `fuzz_clips` draws damages at random, atheris (libFuzzer) follows those that reach new lines
of `gclip`. Each file is held to the same promises: a clip that is evaluated without a fault,
or a ClipError of one sentence, within twice the file and 64 MB, in 20 seconds. Stops at the first
that isn't, with its traceback. Needs the extra `fuzz`, for Linux, and says so without it.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Callable, Iterable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from random import Random

GOOD = 200  # files of `tests.gclip.hostile` to begin with
LARGEST = 1 << 16  # bytes of a file


def main() -> int:
    asked = parser(__doc__).parse_args()
    if is_missing():
        return 2
    import atheris

    with atheris.instrument_imports(include=["gclip"]):
        for name in ("gclip.clip", "gclip.evaluate"):
            import_module(name)
    with tempfile.TemporaryDirectory() as folder:
        look = looking(Path(folder, "case.gclip"))
        fuzz(asked, Path(folder), corpus(asked.seed), look, mutated)
    return 0


def parser(about: str | None) -> argparse.ArgumentParser:
    """The options that fuzzers by coverage share."""
    found = argparse.ArgumentParser(description=(about or "").splitlines()[0])
    found.add_argument("--minutes", type=float, default=10.0)
    found.add_argument("--seed", type=int, default=1)
    found.add_argument("--keep", type=Path, default=Path())
    return found


def is_missing() -> bool:
    """Whether atheris is not installed, which is then said."""
    if find_spec("atheris") is None:
        print("Coverage-guided fuzzing needs atheris: pip install 'plant-growth-clips[fuzz]'.")
        return True
    return False


def fuzz(
    asked: argparse.Namespace,
    folder: Path,
    files: Iterable[bytes],
    look: Callable[[bytes], None],
    mutate: Callable[[bytes, int, Random], bytes] | None = None,
) -> None:
    """Look at files that follow from these, until the time is over, which ends the process."""
    import atheris

    beginning = folder / "corpus"
    beginning.mkdir()
    for number, content in enumerate(files):
        if len(content) <= LARGEST:
            (beginning / f"{number:04d}").write_bytes(content)
    asked.keep.mkdir(parents=True, exist_ok=True)
    options = [
        f"-max_total_time={60 * asked.minutes:.0f}",
        f"-seed={asked.seed}",
        f"-max_len={LARGEST}",
        f"-artifact_prefix={asked.keep}/",
        "-timeout=20",
    ]
    own = mutate and (lambda data, most, seed: mutate(data, most, Random(seed)))
    atheris.Setup([sys.argv[0], str(beginning), *options], look, custom_mutator=own)
    atheris.Fuzz()


def looking(path: Path) -> Callable[[bytes], None]:
    """What is done with each file's bytes."""
    from tests.gclip.fuzz_clips import opened
    from tests.player.uses import evaluated

    def look(data: bytes) -> None:
        path.write_bytes(data)
        clip = opened(path)
        if clip is not None:
            evaluated(clip)

    return look


def mutated(data: bytes, most: int, random: Random) -> bytes:
    """The bytes mutated by libFuzzer; more often than not the document alone, within a container
    that is whole again.
    """
    import atheris

    parts = _parts(data) if random.random() < 0.8 else None
    if parts is None:
        return bytes(atheris.Mutate(data, most))
    header, buffers = parts
    document = header["__metadata__"]["gclip"].encode("utf-8", "surrogatepass")
    changed = atheris.Mutate(document, max(most - len(data) + len(document), 1))
    header["__metadata__"]["gclip"] = changed.decode("utf-8", "replace")
    written = json.dumps(header).encode()
    whole = len(written).to_bytes(8, "little") + written + buffers
    return whole if len(whole) <= most else data


def _parts(data: bytes) -> tuple[dict, bytes] | None:
    """A file's header and buffers, if it is still sound that far."""
    end = 8 + int.from_bytes(data[:8], "little")
    try:
        header = json.loads(data[8:end])
        found = isinstance(header["__metadata__"]["gclip"], str)
    except (ValueError, LookupError, TypeError, RecursionError):
        return None
    return (header, data[end:]) if found else None


def corpus(seed: int) -> list[bytes]:
    """Files to begin with: small clips as they should be, and some that others have spoiled."""
    from tests.gclip.hostile import _contained, good_clips, hostile

    files = [_contained(*parts) for parts in good_clips()]
    return files + [hostile(Random(f"{seed}-{case}")) for case in range(GOOD)]


if __name__ == "__main__":
    sys.exit(main())
