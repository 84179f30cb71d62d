"""Numbers as the page and the terminal show them."""

import math


def figure(value: float | None, unit: str = "") -> str:
    """Three digits with the unit of a measure; a share as percent."""
    if value is None or not math.isfinite(value):
        return "none"
    shown = 100 * value if unit == "%" else value
    text = "0" if shown == 0 else f"{shown:.3g}"
    return f"{text} {unit}".strip()


def measured(value: float | None, unit: str) -> str:
    return "no figure" if value is None else figure(value, unit)


def seconds(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.2g} s" if value < 10 else f"{value:.0f} s" if value < 120 else f"{value / 60:.1f} min"


def speed(value: float | None) -> str:
    return f"{value / 1e6:.2g} M" if value else ""
