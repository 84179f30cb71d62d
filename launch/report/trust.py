"""What a user may trust: figures that every run has, without a reference, against its true error."""

import math

import numpy as np

from case import Case
from charts import COLOURS, MARKS, Line, Plot, draw
from metrics import spearman

# name, where it is in a row of results; a share or a factor, the smaller the better
LIVE = (
    ("mean density error", lambda r: r.get("density_error")),
    ("largest density error", lambda r: r.get("density_max")),
    ("pressure residual (implicit)", lambda r: r.get("pressure_residual") if r["method"] == "implicit" else None),
    ("|change of mass|", lambda r: _size(r.get("mass_drift"))),
    ("momentum given against received", lambda r: r.get("momentum_imbalance")),
    ("energy gained that nobody gave", lambda r: r.get("energy_gain")),
    ("interface residual", lambda r: r.get("interface_residual")),
)
LEAST = 4  # runs of a case from which ranks say something
LEAST_IN_ALL = 30  # runs, over all cases, below which the table would be chance: a report of a case or two


def _size(value: float | None) -> float | None:
    return None if value is None else abs(value)


def true_error(row: dict) -> float | None:
    """The headline error over the first target of the case (that of level 10s), so that cases compare."""
    m = row["measures"][0]
    if row["status"] != "finished" or m["value"] is None or not math.isfinite(m["value"]) or not m.get("scale"):
        return None
    return m["value"] / m["scale"]


def correlation(x: list[float], y: list[float]) -> float | None:
    """Spearman's, where there are runs enough."""
    return spearman(x, y) if len(x) >= LEAST else None


def within(groups: dict[str, list[tuple[float, float]]]) -> tuple[float | None, int]:
    """Mean of the correlations inside groups, weighted by their runs; and how many runs that were."""
    weighted = [(correlation([a for a, _ in g], [b for _, b in g]), len(g)) for g in groups.values()]
    kept = [(c, n) for c, n in weighted if c is not None]
    total = sum(n for _, n in kept)
    return (sum(c * n for c, n in kept) / total, total) if total else (None, 0)


def word(value: float | None) -> str:
    if value is None:
        return "never varies, or too few runs: no measure of error, only of a fault"
    if value <= -0.4:
        return "misleads: the larger, the smaller the error"
    return (
        "tells the better run of a case from the worse"
        if value >= 0.7
        else "leans the right way, no more"
        if value >= 0.4
        else "says little about the error"
    )


def table(cases: list[Case], rows: list[dict], least: int = LEAST_IN_ALL) -> dict:
    """Rows of the table and charts of the figures that vary."""
    known = {c.id for c in cases if not c.stability}
    pairs = [(r, true_error(r)) for r in rows if r["case"] in known and r.get("particles")]
    pairs = [(r, e) for r, e in pairs if e is not None]
    out, charts = [], []
    for name, get in LIVE:
        some = [(get(r), e, r) for r, e in pairs]
        some = [(v, e, r) for v, e, r in some if v is not None and math.isfinite(v)]
        groups: dict[str, list[tuple[float, float]]] = {}
        for v, e, r in some:
            groups.setdefault(f"{r['case']}/{r['method']}", []).append((v, e))
        inside, count = within(groups)
        out.append(
            {
                "name": name,
                "count": len(some),
                "all": correlation([v for v, _, _ in some], [e for _, e, _ in some]),
                "within": inside,
                "within_count": count,
                "word": word(inside),
            }
        )
        if inside is not None:
            charts.append(scatter(name, some))
    return {"rows": out if len(pairs) >= least else [], "charts": [c for c in charts if c]}


def scatter(name: str, some: list[tuple[float, float, dict]]) -> str:
    plot = Plot(name, "true error / target", log_x=True, log_y=True)
    for method in dict.fromkeys(r["method"] for _, _, r in some):
        mine = [(v, e) for v, e, r in some if r["method"] == method and v > 0 and e > 0]
        style = f"points pt {MARKS[method]} ps 0.45 lc rgb '{COLOURS[method]}'"
        if mine:
            plot.lines.append(Line(method, [v for v, _ in mine], [e for _, e in mine], style))
    if not plot.lines or np.ptp(np.log([v for line in plot.lines for v in line.x])) == 0:
        return ""
    plot.levels = [(1.0, "target")]
    return draw(plot)
