"""Text from files that anyone may have written: safe to print, in any terminal and any log."""

from __future__ import annotations

import unicodedata

# Control characters, surrogates, separators of lines, and formats such as those that turn the
# writing's direction; joiners are formats too, and some scripts need them.
_UNSAFE = {"Cc", "Cf", "Cs", "Zl", "Zp"}
_JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"


def printable(text: str, most: int | None = None) -> str:
    """`text` on one line, without anything that a terminal obeys instead of showing.

    Unsafe characters become U+FFFD. most: characters to keep; "…" stands for what follows them.
    """
    if most is not None and len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    return "".join("\N{REPLACEMENT CHARACTER}" if _unsafe(c) else c for c in text)


def _unsafe(character: str) -> bool:
    return unicodedata.category(character) in _UNSAFE and character not in _JOINERS
