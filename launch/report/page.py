"""results.json as one page that opens without a network."""

import math
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader

import reasons
import trust
from case import LEVELS, METHODS, Case
from charts import COLOURS, DASHES, MARKS, Line, Plot, draw, thumbnail
from judge import headline, met_by_level, points_of, times_to_targets, too_slow
from left_out import LEFT_OUT
from metrics import pareto_front, time_to_reach
from references import ReferenceMissing, where_looked
from runs import Place, write_whole
from shown import figure, measured, seconds, speed
from stability import ELSEWHERE

WORD = {"met": "met", "missed": "missed", "no target": "–", "reference not installed": "reference not installed"}


def is_low(order: float | None) -> bool:
    """Below the first order, as shown: a reason is due."""
    return order is not None and order < 0.95


@dataclass(frozen=True)
class Point:
    """One method at one resolution in the chart of error against time; over the variants the worst."""

    method: str
    h: float
    wall_s: float  # of the slowest variant
    error: float  # of the least accurate one, ...
    id: str  # which is this run


def settings(rows: list[dict], index: int) -> list[Point]:
    """Of one method, coarse to fine; all variants must have an error."""
    points = []
    for h in sorted({r["h"] for r in rows}, reverse=True):
        mine = [r for r in rows if r["h"] == h]
        with_error = points_of(mine, index)
        bad = max(with_error, key=lambda r: r["measures"][index]["value"], default=None)
        if bad and len(with_error) == len(mine) and bad["measures"][index]["value"] > 0:
            wall = max(r["wall_s"] for r in mine)
            points.append(Point(bad["method"], h, wall, bad["measures"][index]["value"], bad["id"]))
    return points


def target_lines(case: Case, rows: list[dict], index: int) -> list[tuple[float, str]]:
    """Targets of a measure with a word each: its level, and the variant where they depend on it."""
    measure, out = case.measures[index], {}
    by_variant = {v.name: measure.targets_of(v) for v in case.variants}
    for name, targets in by_variant.items():
        words = ["target"]
        words += [name] if len(set(by_variant.values())) > 1 else []
        for target, level in zip(dict.fromkeys(targets), LEVELS[1:]):
            if any(r["level"] == level for r in rows) or level == "10s":
                out[target] = " ".join(words + ([level] if len(set(targets)) > 1 else []))
    return list(out.items())


def with_target(rows: list[dict], index: int) -> list[dict]:
    """Runs of the variants that a measure is judged at, at some level; all, if it is judged at none."""
    return [r for r in rows if r["measures"][index]["scale"] is not None] or rows


def error_chart(case: Case, rows: list[dict], index: int = 0) -> dict | None:
    """A measure against wall time, log-log, resolutions of one method joined; with the Pareto front's points."""
    measure, rows = case.measures[index], with_target(rows, index)
    plot = Plot(
        "wall time (s)", f"{measure.name}{f' ({measure.unit})' if measure.unit else ''}", log_x=True, log_y=True
    )
    scale = 100 if measure.unit == "%" else 1
    every: list[Point] = []
    for method in dict.fromkeys(r["method"] for r in rows):
        points = settings([r for r in rows if r["method"] == method], index)
        every += points
        style = f"linespoints lc rgb '{COLOURS[method]}' pt {MARKS[method]} ps 0.7 lw 1.2"
        plot.lines.append(Line(method, [p.wall_s for p in points], [scale * p.error for p in points], style))
    front = [every[i] for i in pareto_front([(p.wall_s, p.error) for p in every])]
    xs, ys = [p.wall_s for p in front], [scale * p.error for p in front]
    plot.lines[:0] = [
        Line("", xs, ys, "steps lc rgb '#bbbbbb' lw 3"),
        Line("Pareto front", xs, ys, "points pt 6 ps 1.5 lw 1.5 lc rgb '#888888'"),
    ]
    plot.lines = [line for line in plot.lines if line.x]
    plot.levels = [(scale * target, word) for target, word in target_lines(case, rows, index) if target > 0]
    return {"image": draw(plot), "measure": measure, "front": front} if every else None


def reference_chart(case: Case, number_of_chart: int, rows: list[dict], references: list[Path]) -> tuple[str, str]:
    """Runs at the finest resolution of every method over the reference; and the name of its table, if that is missing."""
    chart = case.charts[number_of_chart]
    plot = Plot(chart.x, chart.y, log_x=chart.log_x)
    missing = ""
    variants = [case.variants[i] for i in case.shown] if case.shown else list(case.variants)
    names = {v.name for v in variants}
    shown = [r for r in rows if r["curves"] and r["variant"] in names]
    with_curve = [(r, curve) for r in shown if (curve := r["curves"][number_of_chart])]
    if chart.reference:
        try:
            for number, variant in enumerate(variants[:1] if chart.joined else variants):
                x, y = chart.reference(variant, references)
                style = (
                    "points pt 6 ps 0.7 lw 1.5 lc rgb 'black'" if chart.points else "lines lc rgb '#222222' lw 3 dt 3"
                )
                plot.lines.append(
                    Line(chart.reference_name if number == 0 else "", list(map(float, x)), list(map(float, y)), style)
                )
        except ReferenceMissing as name:
            missing = str(name)
    for method in dict.fromkeys(r["method"] for r, _ in with_curve):
        mine = [(r, curve) for r, curve in with_curve if r["method"] == method]
        finest = min(r["h"] for r, _ in mine)
        mine = [(r, curve) for r, curve in mine if r["h"] == finest]
        title = f"{method}, {finest:g} {case.unit}"
        colour = COLOURS[method]
        if chart.joined:
            pairs = sorted((x[0], y[0]) for _, (x, y) in mine)
            plot.lines.append(
                Line(
                    title,
                    [p[0] for p in pairs],
                    [p[1] for p in pairs],
                    f"points pt {MARKS[method]} ps 0.8 lc rgb '{colour}'",
                )
            )
            continue
        for number, (row, (x, y)) in enumerate(mine):
            name = f"{title}{', ' + row['variant'] if row['variant'] else ''}"
            plot.lines.append(
                Line(
                    name,
                    x,
                    y,
                    f"lines lw 1.6 lc rgb '{colour}' dt {DASHES[number % len(DASHES)]}",
                )
            )
    exact = [v for line in plot.lines if line.style.startswith(("points pt 6", "lines lc")) for v in line.y]
    if exact and max(exact) - min(exact) > 1e-3 * max(
        abs(v) for v in exact
    ):  # a run that goes astray is cut off, so that the others can be seen
        room = max(exact) - min(exact)
        plot.y_range = (min(exact) - room, max(exact) + room)
    return draw(plot) if with_curve else "", missing


def case_section(place: Place, case: Case, rows: list[dict], trials: list[dict], references: list[Path]) -> dict:
    charts = [reference_chart(case, i, rows, references) for i in range(len(case.charts))]
    folders = [place.out / "runs" / r["id"] for r in rows]
    # Where the target is none at all, yes or no, there is nothing to draw on a logarithm's axis.
    judged = [i for i, m in enumerate(case.measures) if i == 0 or any(t > 0 for v in case.variants for t in m.targets_of(v))]
    groups = list(dict.fromkeys(r["group"] for r in rows))
    return {
        "case": case,
        "why": reasons.sentences(case, case.finding.why, rows + trials),
        "order_why": reasons.sentences(case, case.finding.order_why, rows + trials),
        "tried": reasons.tried(case, rows, trials),
        "references": next((r["report"][at:] for r in rows if (at := r["report"].find(" --references ")) >= 0), ""),
        "rows": sorted(rows, key=lambda r: (groups.index(r["group"]), -r["h"])),
        "missed": any(m["verdict"] == "missed" for r in rows for m in r["measures"]),
        "judged": any(m["target"] is not None for r in rows for m in r["measures"]),
        "low_order": any(is_low(r.get("order")) for r in rows),
        "error_charts": [c for c in (error_chart(case, rows, i) for i in judged) if c],
        "reference_charts": [image for image, _ in charts if image],
        "missing": ", ".join(dict.fromkeys(name for _, name in charts if name)),
        "start": next((t for t in (thumbnail(f / "start.png") for f in folders) if t), ""),
        "picture": next((t for t in (thumbnail(f / "picture.png") for f in folders) if t), ""),
        "times": [table for i in judged for table in times_to_targets(case, rows, i)],
    }


def worst(rows: list[dict], index: int) -> dict:
    """The worst variant of one measure: the largest error over its target, and one without a figure before all."""

    def badness(row: dict) -> float:
        m = row["measures"][index]
        return math.inf if m["value"] is None else m["value"] / (m["target"] or 1)

    return max(with_target(rows, index), key=badness)


def summary(cases: list[Case], rows: list[dict]) -> list[dict]:
    """A line per case and method at its finest resolution; over the variants the worst counts."""
    lines: list[dict] = []
    for case in (c for c in cases if not c.stability):
        for method in case.methods:
            mine = [r for r in rows if r["case"] == case.id and r["method"] == method]
            if not mine:
                continue
            finest = min(r["h"] for r in mine)
            mine = [r for r in mine if r["h"] == finest]
            measures = []
            for index in range(len(case.measures)):
                row, some = worst(mine, index), with_target(mine, index)
                met = sum(r["measures"][index]["verdict"] == "met" for r in some)
                of_row = {"id": row["id"], "variant": row["variant"]}
                measures.append({**row["measures"][index], **of_row, "met": met, "of": len(some)})
            speeds = sorted(r["particle_steps_per_s"] for r in mine if r.get("particle_steps_per_s"))
            walls = [r["wall_s"] for r in mine if r["wall_s"]]
            failed = [r["status"] for r in mine if r["status"] != "finished"]
            shown = worst(mine, 0)
            everything = [r for r in rows if r["group"] == shown["group"]]
            points = [(r["wall_s"], headline(r)["value"]) for r in points_of(everything)]
            target = headline(shown)["target"]
            lines.append(
                {
                    "case": case,
                    "method": method,
                    "h": shown["h"],
                    "measures": measures,
                    "order": shown.get("order"),
                    "low_order": is_low(shown.get("order")),
                    "wall_s": max(walls, default=None),
                    "runs": len(mine),
                    "failed": len(failed),
                    "status": next(iter(failed), ""),
                    "to_target": time_to_reach(target, points) if target is not None else None,
                    "speed": speeds[len(speeds) // 2] if speeds else None,
                    "first": not lines or lines[-1]["case"] is not case,
                }
            )
    return lines


def stability(cases: list[Case], rows: list[dict]) -> list[dict]:
    """Of the stability suite: per case its runs, each with the verdict "stable", "stopped cleanly" or "not stable"."""
    lines = []
    for case in (c for c in cases if c.stability):
        mine = [dict(r) for r in rows if r["case"] == case.id]
        for row in mine:
            fine = row["status"] == "finished" and all(m["verdict"] == "met" for m in row["measures"])
            row["stable"] = (
                "stable"
                if fine
                else "stopped cleanly"
                if case.to_the_limit and row["status"] == "diverged"
                else "not stable"
            )
        if mine:
            lines.append({"case": case, "rows": mine, "not_stable": sum(r["stable"] == "not stable" for r in mine)})
    return lines


def methods(rows: list[dict]) -> list[dict]:
    """What the methods are, and which coupling scheme the runs with bodies in a fluid got, by the cases."""
    out = []
    for method in (m for name, m in METHODS.items() if any(r["method"] == name for r in rows)):
        schemes: dict[str, set] = {}
        for r in rows:
            if r["method"] == method.name and r.get("scheme") and r.get("momentum_imbalance") is not None:
                schemes.setdefault(r["scheme"], set()).add(r["case"])
        ordered = sorted(schemes.items(), key=lambda s: -len(s[1]))
        out.append({"method": method, "schemes": [(s, sorted(c) if len(c) < 10 else []) for s, c in ordered]})
    return out


def tally(rows: list[dict]) -> dict[str, int]:
    """How many figures of all runs with a target met it."""
    verdicts = [m["verdict"] for r in rows for m in r["measures"]]
    return {word: verdicts.count(word) for word in ("met", "missed", "reference not installed")}


def write(
    place: Place, cases: list[Case], results: dict, references: list[Path], changes: dict | None, part: str
) -> Path:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"figure": figure, "measured": measured, "seconds": seconds, "speed": speed}
    environment.tests["low_order"] = is_low
    rows, trials = results["rows"], results["trials"]
    sections = [
        case_section(place, case, *([r for r in some if r["case"] == case.id] for some in (rows, trials)), references)
        for case in cases
        if not case.stability and any(r["case"] == case.id for r in rows)
    ]
    text = environment.get_template("page.html.j2").render(
        results=results,
        sections=sections,
        summary=summary(cases, rows),
        stability=stability(cases, rows),
        methods=methods(rows),
        elsewhere=ELSEWHERE,
        left_out=LEFT_OUT,
        trust=trust.table(cases, rows),
        tally=tally(rows),
        where_looked=where_looked(references),
        staggered=tally([r for r in rows if r["method"] == "staggered"])["missed"],
        levels=met_by_level(cases, rows),
        too_slow=too_slow(rows),
        changes=changes,
        word=WORD,
    )
    path = place.out / f"report{part}.html"
    write_whole(path, text)
    return path
