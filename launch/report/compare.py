"""What became better, worse, faster or slower since other results."""

import json
from pathlib import Path

from case import Refused
from shown import figure, seconds

ERROR_NOISE = 0.02  # a run repeats bit for bit, so this is only what is worth a line
TIME_NOISE = 0.25  # single runs on a machine with other work on it; less if both are medians of several
SHORT = 0.3  # s; shorter runs say nothing about speed


def load(path: Path) -> dict:
    path = path / "results.json" if path.is_dir() else path
    if not path.is_file():
        part = path.with_name("results_part.json")
        cure = f"there is {part}, of a choice of cases: give that" if part.is_file() else "give results.json of another report, or its folder"
        raise Refused(f"--against: there is no {path}; {cure}")
    return json.loads(path.read_text())


def time_noise(walls: list[float]) -> float:
    """Relative scatter allowed for: three times the spread of repeated runs, but never below 5 %."""
    if len(walls) < 2:
        return TIME_NOISE
    return max(0.05, 3 * (max(walls) - min(walls)) / min(walls) / 2)


def most_load(rows: list[dict]) -> float:
    """That a report makes by itself: the fluid's threads, and the rigid process beside them (2.6 seen with two on an idle machine).
    The load of a run is that of the minute before it: of other runs of the report."""
    return max((r["threads"] for r in rows if r.get("threads")), default=1) + 1


def _line(row: dict, what: str, before: str, now: str, factor: float | None, good: bool, word: str) -> dict:
    return {
        "id": row["id"],
        "what": what,
        "before": before,
        "now": now,
        "good": good,
        "word": word,
        "factor": f"{factor:.2f}" if factor is not None else "",
    }


def changes(old: dict, new: dict, against: str) -> dict:
    before = {r["id"]: r for r in old["rows"]}
    lines, same, no_times = [], 0, 0
    calm_before, calm_now = most_load(old["rows"]), most_load(new["rows"])
    for row in new["rows"]:
        was = before.get(row["id"])
        if was is None:
            continue
        same += 1
        if row["status"] != was["status"]:
            lines.append(
                _line(
                    row,
                    "run",
                    was["status"],
                    row["status"],
                    None,
                    row["status"] == "finished",
                    "better" if row["status"] == "finished" else "worse",
                )
            )
        old_measures = {m["name"]: m["value"] for m in was["measures"]}
        for m in row["measures"]:
            a, b = old_measures.get(m["name"]), m["value"]
            if a is None or b is None or a == b or abs(b - a) <= ERROR_NOISE * abs(a):
                continue
            lines.append(
                _line(
                    row,
                    m["name"],
                    figure(a, m["unit"]),
                    figure(b, m["unit"]),
                    b / a if a else None,
                    b < a,
                    "better" if b < a else "worse",
                )
            )
        if was["load"] > calm_before or row["load"] > calm_now:  # others were at work
            no_times += 1
            continue
        a, b = was["wall_s"], row["wall_s"]
        noise = max(time_noise(was["walls"]), time_noise(row["walls"]))
        if a and b and max(a, b) > SHORT and max(a, b) / min(a, b) > 1 + noise:
            lines.append(_line(row, "wall time", seconds(a), seconds(b), b / a, b < a, "faster" if b < a else "slower"))
    machines = "" if old["machine"] == new["machine"] else f" Other machine: {old['machine']}; times do not compare."
    busy = f" Wall times are not compared where others were at work on the machine: {no_times} runs." if no_times else ""
    note = (
        f"{same} runs in common, {len(new['rows']) - same} only here. Errors that changed by more than {100 * ERROR_NOISE:g} %, "
        f"wall times by more than their noise ({100 * TIME_NOISE:g} % for single runs).{machines}{busy}"
    )
    if old.get("command"):
        note += f" Before: {old['command']} at {old.get('commit')}."
    return {"against": against, "note": note, "lines": lines}


def in_words(found: dict) -> str:
    """A line for the terminal: how many of each."""
    words = [line["word"] for line in found["lines"]]
    counts = ", ".join(f"{words.count(word)} {word}" for word in ("better", "worse", "faster", "slower") if word in words)
    return f"against {found['against']}: {counts or 'no change beyond noise'}; {found['note']}"
