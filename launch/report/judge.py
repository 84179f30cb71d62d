"""From a finished run to a row of figures: errors against targets, balances, where the time went."""

import re
from pathlib import Path

import numpy as np

from case import LEVELS, Case, Chart, Job, Outcome
from metrics import NoFigure, observed_order, pareto_front, time_to_reach
from references import ReferenceMissing
from runs import EXPECTED, Place, shown_command

CURVE_POINTS = 400  # of a curve kept for the page
HEADLINES = ("B1", "B4", "B7", "B10", "B11", "X1")  # of the plan: the cases that two-way coupling stands for
ABSENT = "reference not installed"


def judge(place: Place, job: Job, note: dict, references: list[Path]) -> dict:
    """A row of results.json."""
    row = {
        "id": job.id,
        "group": job.group,
        "case": job.case.id,
        "variant": job.variant.name,
        "method": job.method,
        "level": job.level,
        "h": job.h,
        "trial": job.trial.name if job.trial else "",
        "base": job.base,
        "status": note["status"],
        "message": note["message"],
        "wall_s": note["wall_s"],
        "walls": note["walls"],
        "started": note["started"],
        "load": note["load"],
        "run": shown_command(job),
        "report": f"./launch/ballast report {job.id}",
        "measures": [],
        "curves": [],
    }
    outcome = None
    if note["status"] == "finished":
        outcome = Outcome(place.run_folder(job), job.h, job.variant, references)
        row |= _figures(outcome)
        row["curves"] = [_curve(chart, outcome) for chart in job.case.charts]
    stopped_as_wanted = job.case.to_the_limit and note["status"] == "diverged"
    for measure in job.case.measures:
        target = None if stopped_as_wanted or job.trial else measure.target(job.variant, job.level)
        value, remark, verdict = None, "", None
        try:
            if outcome:
                value = float(measure.value(outcome))
        except NoFigure as why:
            remark = str(why)
        except ReferenceMissing as why:
            remark, verdict = f"{why} is not installed", ABSENT
        entry = {"name": measure.name, "unit": measure.unit, "value": value, "target": target, "note": remark}
        targets = measure.targets_of(job.variant)
        entry["scale"] = targets[0] if targets else None  # what errors of different cases are compared in
        entry["verdict"] = verdict or _verdict(value, target)
        row["measures"].append(entry)
    row["with_references"] = outcome is not None and outcome.asked_for_references
    return row


def _verdict(value: float | None, target: float | None) -> str:
    """No figure is a miss wherever there is a target: a run that fails does not pass."""
    if target is None:
        return "no target"
    return "met" if value is not None and np.isfinite(value) and value <= target else "missed"


def _figures(outcome: Outcome) -> dict:
    r = outcome.record
    ledger, particles = r.get("ledger") or {}, r.get("particles") or {}
    energy = ledger.get("energy_J") or {}
    expects = r.get("expect") or []
    stages = {k: v for k, v in (r.get("stages") or {}).items() if v and not k.startswith("rigid.")}
    if not stages:  # no fluid process
        stages = {k: v for k, v in (r.get("stages") or {}).items() if v}
    return {
        "steps": r["steps"],
        "particles": particles.get("fluid"),
        "samples": particles.get("boundary"),
        "lost": particles.get("lost"),
        "particle_steps_per_s": r.get("particle_steps_per_s"),
        "simulated_s": r["simulated_s"],
        "momentum_imbalance": ledger.get("imbalance_relative"),
        "mass_drift": ledger.get("mass_drift"),
        "energy_change_J": energy.get("change"),
        "energy_balance_J": energy.get("gain"),
        "energy_scale_J": energy.get("reference"),
        "density_error": (r.get("error") or {}).get("density_mean"),
        "density_max": (r.get("error") or {}).get("density_max"),
        "pressure_residual": (r.get("error") or {}).get("pressure_residual"),
        "energy_gain": (r.get("error") or {}).get("energy_gain"),
        "interface_residual": (r.get("error") or {}).get("interface_residual"),
        "expectations": [sum(1 for e in expects if e["pass"]), len(expects)],
        "warnings": r.get("warnings", []),
        "stages": stages,
        "machine": r["machine"],
        "version": r["version"],
        "threads": r["threads"],
        "scheme": r.get("scheme"),
        "state_hash": r.get("state_hash"),
    }


def _curve(chart: Chart, outcome: Outcome) -> list[list[float]] | None:
    try:
        x, y = (np.atleast_1d(np.asarray(v, float)) for v in chart.run(outcome))
    except (NoFigure, ReferenceMissing):
        return None
    chosen = np.unique(np.linspace(0, x.size - 1, min(x.size, CURVE_POINTS)).astype(int))
    return [x[chosen].tolist(), y[chosen].tolist()]


def headline(row: dict) -> dict:
    return row["measures"][0]


def absolute_error(row: dict) -> float | None:
    """The headline's error as it converges: one given in spacings, in metres."""
    error = headline(row)
    return error["value"] * row["h"] if error["value"] is not None and error["unit"] == "dx" else error["value"]


def number_of(case: str) -> str:
    """The plan's id that a case is or is a part of: B4 of B4s."""
    return re.match(r"[A-Z]\d*", case)[0]


def met_by_level(cases: list[Case], rows: list[dict]) -> list[dict]:
    """Per level: how many validation cases (F, B, X) meet all their targets with at least one solver, and how
    many with each alone. Cases that share a number (B4, B4s, B4w) are parts of one; it is met if all are.
    A case without a run at a level counts there as at the level below. The staggered scheme does not count: it
    is there to show where it fails. A case with a figure whose reference is not installed is not judged at all."""
    lines = []
    absent = {r["case"] for r in rows if any(m["verdict"] == ABSENT for m in r["measures"])}
    half_judged = {number_of(case) for case in absent}
    pairs: dict[tuple[str, str], bool] = {}
    for level in LEVELS[1:]:
        at_level = {}
        for case in (c for c in cases if not c.stability and c.id[0] in "FBX" and c.id not in absent):
            for method in (m for m in case.methods if m != "staggered"):
                mine = [r for r in rows if (r["case"], r["method"], r["level"]) == (case.id, method, level)]
                verdicts = [m["verdict"] for r in mine for m in r["measures"] if m["verdict"] in ("met", "missed")]
                if verdicts:
                    at_level[case.id, method] = all(v == "met" for v in verdicts)
        run_here = {case for case, _ in at_level}
        pairs = {p: met for p, met in pairs.items() if p[0] not in run_here} | at_level
        by_method = {
            method: [met for (_, used), met in pairs.items() if used == method] for method in dict.fromkeys(m for _, m in pairs)
        }
        by_case = {c: any(met for (case, _), met in pairs.items() if case == c) for c, _ in pairs}
        numbers: dict[str, bool] = {}
        for name, met in by_case.items():
            if (number := number_of(name)) not in half_judged:
                numbers[number] = numbers.get(number, True) and met
        if at_level:
            lines.append(
                {
                    "level": level,
                    "cases_met": sum(by_case.values()),
                    "cases": len(by_case),
                    "numbers_met": sum(numbers.values()),
                    "numbers": len(numbers),
                    "missed": [c for c, met in by_case.items() if not met],
                    "headlines": [
                        (number, next(c for c in by_case if number_of(c) == number), numbers[number])
                        for number in HEADLINES
                        if number in numbers
                    ],
                    "unjudged": [c.id for c in cases if c.id in absent],
                    "by_method": [(method, sum(met), len(met)) for method, met in by_method.items()],
                }
            )
    return lines


def too_slow(rows: list[dict]) -> list[dict]:
    """Runs that took more than twice what their level allows: they are not what that level stands for."""
    return [r for r in rows if (r["wall_s"] or 0) > 2 * EXPECTED[r["level"]]]


def points_of(rows: list[dict], index: int = 0) -> list[dict]:
    """Rows that are a point in the chart of the error `index` (0: the headline's) against time."""
    return [r for r in rows if r["wall_s"] and r["measures"][index]["value"] is not None]


def mark(rows: list[dict]) -> None:
    """Adds to the rows of one case: observed order against the next coarser run, and whether on the Pareto front."""
    groups: dict[str, list[dict]] = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    for members in groups.values():
        members.sort(key=lambda r: -r["h"])
        for coarse, fine in zip(members, members[1:]):
            pair = absolute_error(coarse), absolute_error(fine)
            fine["order"] = observed_order(coarse["h"], pair[0], fine["h"], pair[1]) if None not in pair else None
    for variant in {r["variant"] for r in rows}:
        some = points_of([r for r in rows if r["variant"] == variant])
        for index in pareto_front([(r["wall_s"], headline(r)["value"]) for r in some]):
            some[index]["pareto"] = True


def times_to_targets(case: Case, rows: list[dict], index: int = 0) -> list[dict]:
    """The wall time that every group needs to reach each target of a measure; None where not reached. Groups with the
    same targets together."""
    tables: dict[tuple[float, ...], list[dict]] = {}
    variants = {v.name: v for v in case.variants}
    for group in dict.fromkeys(r["group"] for r in rows):
        members = [r for r in rows if r["group"] == group]
        targets = tuple(dict.fromkeys(case.measures[index].targets_of(variants[members[0]["variant"]])))
        points = [(r["wall_s"], r["measures"][index]["value"]) for r in points_of(members, index)]
        tables.setdefault(targets, []).append({"group": group, "times": [time_to_reach(t, points) for t in targets]})
    return [
        {"measure": case.measures[index], "targets": targets, "lines": lines} for targets, lines in tables.items() if targets
    ]
