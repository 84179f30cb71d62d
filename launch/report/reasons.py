"""Reasons why a case misses: sentences whose figures come from the results, and the runs made to find them out."""

import fnmatch
import re

import numpy as np
from markupsafe import Markup, escape

from case import Case
from shown import figure

FIELD = re.compile(r"\{([^{}|]+)(?:\|(\d+))?\}")  # {run} or {run|measure}: r0.1/wcsph/0.01, wcsph/*, wcsph/0.01+viscous|1
NO_RUN = "…"
LATER = "…: figures of runs that the level 1min makes: ./launch/ballast report {} --level 1min"


def fields(text: str) -> list[tuple[str, int]]:
    """The runs, without their case, and measures that a text quotes."""
    return [(run, int(measure or 0)) for run, measure in FIELD.findall(text)]


def matching(case: str, run: str, rows: list[dict]) -> list[dict]:
    return [r for r in rows if fnmatch.fnmatchcase(r["id"], f"{case}/{run}") and ("+" in run) == bool(r["trial"])]


def between(values: list[float], unit: str) -> str:
    """One figure, or the least and the largest: 3.5 to 5.5 %."""
    least, most = figure(min(values), unit), figure(max(values), unit)
    return least if least == most else f"{least.removesuffix(unit).strip()} to {most}"


def sentences(case: Case, text: str, rows: list[dict]) -> list[Markup]:
    """A text, a sentence or a few per line, with its figures, each a link to its run."""

    def quoted(found: re.Match) -> str:
        run, index = found[1], int(found[2] or 0)
        measure = case.measures[index]
        mine = matching(case.id, run, rows)
        values = [r["measures"][index]["value"] for r in mine]
        values = [v for v in values if v is not None and np.isfinite(v)]
        if not values:
            return NO_RUN if not mine else "none"
        return f'<a href="#{escape(mine[0]["id"])}">{escape(between(values, measure.unit))}</a>'

    lines = [FIELD.sub(quoted, str(escape(line))) for line in text.splitlines() if line]
    if any(NO_RUN in line for line in lines):
        lines.append(LATER.format(case.id))
    return [Markup(line) for line in lines]


def tried(case: Case, rows: list[dict], trials: list[dict]) -> list[dict]:
    """The runs that trials changed and, behind each, what they were changed to."""
    changed = {trial.name: trial.changed for trial in case.finding.trials}
    lines: list[dict] = []
    for base in dict.fromkeys(r["base"] for r in trials):
        before = [r for r in rows if r["id"] == base]
        lines += [{"row": r, "changed": ""} for r in before]
        same = {r["state_hash"] for r in before if r.get("state_hash")}
        for r in (r for r in trials if r["base"] == base):
            nothing = " (the same, bit for bit: it changes nothing here)" if r.get("state_hash") in same else ""
            lines.append({"row": r, "changed": changed[r["trial"]] + nothing})
    return lines
