"""Format the distances between a clip and the scans that were left out of it."""

from collections.abc import Sequence

from traits.holdout_error import HoldoutError, overall


def error_lines(errors: Sequence[HoldoutError], unit: str) -> list[str]:
    """Format the errors as a table, with a row for each scan and one for all together."""
    rows = [(f"{error.date}, {error.name}", error.distances) for error in errors]
    rows += [("all", overall(errors))] if len(errors) > 1 else []
    title = f"left out{unit and f' ({unit})'}"
    width = max(len(title), *(len(name) for name, _ in rows))
    return [
        f"{'':<{width}}{'reconstruction to scan':>30}{'scan to reconstruction':>30}",
        f"{title:<{width}}" + f"{'mean':>10}{'std':>10}{'max':>10}" * 2,
        *(f"{n:<{width}}" + "".join(f"{v:>10.3g}" for v in (*a, *b)) for n, (a, b) in rows),
    ]
