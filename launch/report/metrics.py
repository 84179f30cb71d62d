"""Figures from curves and from pairs (error, run time): pure functions of numbers, each with a test of its own."""

import math
from collections.abc import Sequence

import numpy as np

Array = np.ndarray
IMPACT_S = 1e-3  # s, over which pressures and forces at impacts are averaged


class NoFigure(ValueError):
    """A curve does not hold what is asked of it, such as a period in a motion that never turns."""


def resample(t: Array, y: Array, at: Array) -> Array:
    """y(t) at other times, linearly; times outside t are an error, not an extrapolation."""
    slack = 1e-9 * max(1.0, float(np.max(np.abs(t))))
    if at.size == 0 or at[0] < t[0] - slack or at[-1] > t[-1] + slack:
        raise NoFigure(f"the run covers {t[0]:.4g} to {t[-1]:.4g} s, the reference {at[0]:.4g} to {at[-1]:.4g} s")
    return np.interp(at, t, y)


def running_mean(t: Array, y: Array, width: float) -> Array:
    """Mean of y over width / 2 to both sides of each time, y linear between rows and constant beyond its ends."""
    before = np.concatenate([[0], np.cumsum(np.diff(t) * (y[1:] + y[:-1]) / 2)])

    def integral(x: Array) -> Array:
        row = np.clip(np.searchsorted(t, x, side="right") - 1, 0, t.size - 1)
        return before[row] + (x - t[row]) * (y[row] + np.interp(x, t, y)) / 2

    first = np.minimum(t - width / 2 - t[0], 0) * y[0]  # what lies before the first row
    return (integral(t + width / 2) - integral(np.maximum(t - width / 2, t[0])) - first) / width


def first_row(holds: Array, otherwise: str) -> int:
    """Index of the first row where it holds; if there is none, NoFigure that says so."""
    rows = np.nonzero(holds)[0]
    if rows.size == 0:
        raise NoFigure(otherwise)
    return int(rows[0])


def rms(difference: Array) -> float:
    return float(np.sqrt(np.mean(np.square(difference))))


def nrmse(simulated: Array, reference: Array) -> float:
    """Root mean square deviation over the range of the reference, both on the reference's sample times."""
    return rms(simulated - reference) / float(np.max(reference) - np.min(reference))


def relative(value: float, exact: float) -> float:
    return abs(value - exact) / abs(exact)


def slope(t: Array, y: Array) -> float:
    """Slope of the straight line of least squares."""
    if t.size < 2:
        raise NoFigure("fewer than two rows lie in the window of time")
    return float(np.polyfit(t - t.mean(), y, 1)[0])


def crossings(t: Array, y: Array) -> Array:
    """Times at which y passes through zero, linear between rows."""
    before, after = y[:-1], y[1:]
    found = np.nonzero((before < 0) & (after >= 0) | (before > 0) & (after <= 0))[0]
    return t[found] - y[found] * (t[found + 1] - t[found]) / (y[found + 1] - y[found])


def period(t: Array, y: Array, first: int = 0, count: int | None = None) -> float:
    """Mean time of a full swing about zero, from crossing `first` on, over `count` half swings or all."""
    zero = crossings(t, y)[first:]
    if count is not None:
        zero = zero[: count + 1]
    if zero.size < 2 or (count is not None and zero.size < count + 1):
        raise NoFigure(f"the motion passes through zero only {zero.size} times after the first {first}")
    return 2 * float(zero[-1] - zero[0]) / (zero.size - 1)


def extrema(t: Array, y: Array) -> tuple[Array, Array]:
    """Times and values of the largest |y| between successive zero crossings."""
    zero = crossings(t, y)
    times, values = [], []
    for start, stop in zip(zero, zero[1:]):
        inside = np.nonzero((t >= start) & (t <= stop))[0]
        if inside.size:
            top = inside[np.argmax(np.abs(y[inside]))]
            times.append(t[top])
            values.append(y[top])
    return np.array(times), np.array(values)


def settles_to(tops: Array) -> tuple[float, float]:
    """c and q of extremes c + a (-q)^n, by least squares: where a swing that loses 1 - q of its height each half period
    comes to rest. Losses do not shift it as they do a mean."""
    n = np.arange(tops.size)
    best = (np.inf, 0.0, 0.0)
    for q in np.linspace(0.5, 1, 1001):
        system = np.stack([np.ones(n.size), (-q) ** n], axis=1)
        fit, *_ = np.linalg.lstsq(system, tops, rcond=None)
        best = min(best, (float(np.sum(np.square(system @ fit - tops))), float(fit[0]), float(q)))
    return best[1:]


def decay_rate(t: Array, y: Array, first: int = 0, count: int | None = None) -> float:
    """s of y ~ exp(-s t) cos(...), from the logarithms of `count` extrema from `first` on, or all; 1/s."""
    times, values = (e[first:][:count] for e in extrema(t, y))
    if count is not None and times.size < count:
        raise NoFigure(f"the motion has only {times.size} extrema after the first {first}")
    return -slope(times, np.log(np.abs(values)))


def observed_order(coarse_h: float, coarse_error: float, fine_h: float, fine_error: float) -> float | None:
    """p of error ~ h^p between two resolutions; nothing where an error is zero or unknown."""
    if not (coarse_error and fine_error) or coarse_h == fine_h:
        return None
    return math.log(coarse_error / fine_error) / math.log(coarse_h / fine_h)


def time_to_reach(target: float, points: Sequence[tuple[float, float]]) -> float | None:
    """Wall time at which the error falls to the target, by log interpolation between (wall time, error) points.

    The cheapest point that meets the target is where the search starts; between it and the next cheaper one, whose error
    is larger, the error is taken as a power of the time. Nothing if no point meets the target.
    """
    ordered = sorted(points)
    for index, (time, error) in enumerate(ordered):
        if error > target:
            continue
        if index == 0:
            return time
        cheaper, larger = ordered[index - 1]
        if error <= 0 or time <= cheaper:
            return time
        share = math.log(larger / target) / math.log(larger / error)
        return math.exp(math.log(cheaper) + share * (math.log(time) - math.log(cheaper)))
    return None


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indexes of the points (wall time, error) that no other point beats in both, cheapest first."""
    front, best = [], math.inf
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if points[index][1] < best:
            best = points[index][1]
            front.append(index)
    return front


def best_shift(t: Array, y: Array, at: Array, reference: Array, largest: float) -> tuple[float, float]:
    """Time shift within +-largest that makes the NRMSE smallest, and that NRMSE; the run may end a shift early."""

    def error(shift: float) -> float:
        return nrmse(np.interp(at + shift, t, y), reference)

    shift = min(np.linspace(-largest, largest, 201), key=error)
    return float(shift), error(shift)


def ranks(values: Sequence[float]) -> Array:
    """1 for the smallest; equal values share the mean of their places."""
    y = np.asarray(values, float)
    _, which, counts = np.unique(y, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - (counts - 1) / 2)[which]


def spearman(x: Sequence[float], y: Sequence[float]) -> float | None:
    """Rank correlation: Pearson's of the ranks; nothing where one of both does not vary."""
    a, b = ranks(x), ranks(y)
    a, b = a - a.mean(), b - b.mean()
    size = math.sqrt(float(a @ a) * float(b @ b))
    return float(a @ b) / size if size else None
