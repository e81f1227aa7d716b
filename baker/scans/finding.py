"""What a bake decided by itself, and how sure it is of that."""

from dataclasses import dataclass

TOPICS = ("order", "days", "points", "unit", "ground", "up", "frame", "plant", "labels", "organs")


@dataclass(frozen=True)
class Finding:
    """One decision for a whole series, as `bake --list` and the first lines of a bake print it.

    topic:  one of TOPICS, in whose order they are printed.
    found:  what was decided and by which rule, in a botanist's words: "z, as scans usually have".
    doubt:  what speaks against it, a clause without a full stop; "" where nothing does.
    option: how to say it otherwise: "--up y". Named wherever there is a doubt.
    """

    topic: str
    found: str
    doubt: str = ""
    option: str = ""

    @property
    def remark(self) -> str:
        """The doubt and the option that settles it; "" where nothing is in doubt."""
        return (
            f"{self.doubt}; say it with {self.option}" if self.doubt and self.option else self.doubt
        )

    @property
    def sentence(self) -> str:
        """The finding as a line of text."""
        doubt = f" Look at this: {self.remark}." if self.doubt else ""
        return f"{self.topic}: {self.found}.{doubt}"
