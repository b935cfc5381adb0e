"""How numbers are written for people."""

import math
from collections.abc import Iterable, Sequence
from typing import SupportsFloat


def number(x: SupportsFloat) -> str:
    """Three significant digits."""
    return f"{float(x):.3g}".replace("-", "−")


def percent(share: SupportsFloat) -> str:
    return f"{100 * float(share):.3g} %"


DIGITS = 5


def aligned(
    values: Iterable[SupportsFloat], largest: float | None = None, digits: int = DIGITS
) -> Sequence[str]:
    """Numbers with the same decimals, so many that the largest shows the digits asked for."""
    given = [float(v) for v in values]
    top = largest if largest is not None else max((abs(v) for v in given), default=0.0)
    magnitude = math.floor(math.log10(top)) if top > 0 and math.isfinite(top) else 0
    decimals = min(max(digits - 1 - magnitude, 0), digits + 1)
    least = 0.5 * 10.0**-decimals

    def text(v: float) -> str:
        if abs(v) <= 1e-15 * top:
            return "0"
        shown = f"{v:.0e}" if abs(v) < least else f"{v:.{decimals}f}"
        return shown.replace("-", "−")

    return [text(v) for v in given]
