"""Text from files that anyone may have written: safe to print, in any terminal and any log."""

import unicodedata

# Control characters, surrogates, separators of lines, and formats such as those that turn the
# direction of writing; joiners are formats too, and some scripts need them.
UNSAFE = {"Cc", "Cf", "Cs", "Zl", "Zp"}
JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"


def printable(text: str, most: int | None = None) -> str:
    """`text` on one line, with U+FFFD for what a terminal would obey instead of showing.

    most: characters to keep; "…" stands for what follows them.
    """
    if most is not None and len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    return "".join("\N{REPLACEMENT CHARACTER}" if _unsafe(c) else c for c in text)


def _unsafe(character: str) -> bool:
    return unicodedata.category(character) in UNSAFE and character not in JOINERS
