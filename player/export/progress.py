"""How an export tells where it is."""

from gclip.terminal.progress import ProgressBars


class FrameProgress(ProgressBars):
    """An instance is the `progress` callable of `export`: steps done, steps in all."""

    def __init__(self, quiet: bool = False, doing: str = "drawing") -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, TimeRemainingColumn

        super().__init__(quiet, doing, BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        self._task = self.bars.add_task(doing, total=None)
        self._doing = doing
        self._tenth = 0

    def __call__(self, done: int, total: int) -> None:
        self.bars.update(self._task, completed=done, total=total)
        if self.plain and 10 * done // total > self._tenth:
            self._tenth = 10 * done // total
            self.say(f"{self._doing}: {done} of {total}")
