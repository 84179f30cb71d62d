"""`ballast report`: runs the validation cases and writes results.json, results.csv and report.html."""

import argparse
import contextlib
import csv
import datetime
import fcntl
import fnmatch
import io
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from tqdm import tqdm

import compare
import page
from case import LEVELS, METHODS, Case, Job, Refused, jobs_of, with_those_beside
from cases import ALL
from judge import judge, mark, number_of
from references import where_looked
from runs import EXPECTED, Place, build_hash, draw_start, finished, key_of, make, write_whole
from shown import measured


def arguments(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="ballast report",
        description="Runs validation cases and shows their error against run time on one page.",
        epilog="Finished runs of the same scene and the same programs are kept and not made again.",
    )
    parser.add_argument(
        "cases", nargs="*", metavar="CASES", help="such as F1, 'R*' or B4/r0.01/wcsph/0.005; all by default"
    )
    parser.add_argument(
        "--level", choices=LEVELS[1:], default="10s", help="what a run may cost on two cores (default: 10s)"
    )
    parser.add_argument("--methods", nargs="+", metavar="METHOD", help=f"of {', '.join(METHODS)}; all by default")
    parser.add_argument(
        "--references", type=Path, metavar="DIR", help="folder with tables that may not be carried along"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("out/report"), metavar="DIR", help="results (default: out/report)"
    )
    parser.add_argument("--against", type=Path, metavar="OLD", help="results.json, or its folder, to compare with")
    parser.add_argument(
        "--repeats", type=int, default=1, metavar="N", help="wall times as medians of N runs (default: 1)"
    )
    parser.add_argument("--again", action="store_true", help="make finished runs again")
    parser.add_argument("--gate", action="store_true", help="exit code 3 where a figure misses its target or has no reference, or a run ends early")
    parser.add_argument("--list", action="store_true", help="print the runs and whether they are finished; make none")
    parser.add_argument("--build", type=Path, required=True, help=argparse.SUPPRESS)
    chosen = parser.parse_args(words)
    # "--methods wcsph F1": words behind it that are no methods are cases, or refused as neither.
    words_after = chosen.methods or []
    chosen.cases += [w for w in words_after if w not in METHODS]
    chosen.methods = [w for w in words_after if w in METHODS]
    if words_after and not chosen.methods:
        parser.error(f"--methods names none ({', '.join(words_after)}); methods are {', '.join(METHODS)}")
    if chosen.repeats < 1:
        parser.error(f"--repeats is {chosen.repeats}; give 1 or more")
    return chosen


def fits(job: Job, patterns: list[str]) -> bool:
    return not patterns or any(
        fnmatch.fnmatchcase(job.id, p) or fnmatch.fnmatchcase(job.id, p + "/*") for p in patterns
    )


def cases_of(pattern: str) -> list[str]:
    """X1a and X1b for X1, which the plan names and no case is."""
    parts = [case.id for case in ALL if number_of(case.id) == pattern]
    return [pattern] if pattern in parts or not parts else parts


def fits_case(job: Job, pattern: str) -> bool:
    """Whether it only is in upper and lower case that they differ."""
    return f"{job.id}/".lower().startswith(f"{pattern}/".lower())


def choose(chosen: argparse.Namespace) -> list[Job]:
    methods = set(chosen.methods) if chosen.methods else None
    by_any = [job for case in ALL for job in jobs_of(case, LEVELS[-1], None)]
    everything = [job for job in by_any if not methods or job.method in methods]
    asked = [p for word in chosen.cases for p in cases_of(word)]
    # A run that is named by its whole id is meant whatever its level.
    named = {job.id for job in everything} & set(asked)
    patterns = [p for p in asked if p not in named]
    for pattern in asked:
        if any(fits(job, [pattern]) for job in everything):
            continue
        others = list(dict.fromkeys(job.method for job in by_any if fits(job, [pattern])))
        if others:
            raise Refused(f"{pattern} is not run by {', '.join(chosen.methods)}, but by {', '.join(others)}")
        known = f"cases are {', '.join(c.id for c in ALL)}; methods are {', '.join(METHODS)}"
        meant = next((job.id for job in by_any if fits_case(job, pattern)), None)
        raise Refused(f"no run fits {pattern}{f', but {meant[: len(pattern)]} would' if meant else ''}; {known}")
    affordable = LEVELS[: LEVELS.index(chosen.level) + 1]
    wanted = [
        job
        for job in everything
        if job.id in named or (job.level in affordable and (patterns or not named) and fits(job, patterns))
    ]
    return with_those_beside(wanted, everything)


def reference_folders(place: Place, given: Path | None) -> list[Path]:
    """The folder given, or the usual place, and the tables that are the project's own."""
    if given and not given.is_dir():
        raise Refused(f"--references: {given} is no folder")
    return [
        given.resolve() if given else place.tree.parent / "shared/reference",
        place.tree / "tests/validation/reference",
    ]


def pictured(jobs: list[Job]) -> set[str]:
    """One run of each case with a section draws pictures: the first of its finest resolution."""
    out: dict[str, Job] = {}
    for job in (j for j in jobs if not j.case.stability and not j.trial):
        best = out.get(job.case.id)
        if best is None or job.h < best.h:
            out[job.case.id] = job
    return {job.id for job in out.values()}


def commit(tree: Path) -> str:
    result = subprocess.run(["git", "-C", str(tree), "describe", "--always", "--dirty"], capture_output=True, text=True)
    return result.stdout.strip() if result.returncode == 0 else "no git"


# Of a row of results.json, in results.csv: what it is, by its name there; figures of the whole run, in all its lines.
COLUMNS = {
    "id": "run",
    "case": "case",
    "variant": "variant",
    "method": "method",
    "trial": "trial",
    "level": "level",
    "h": "resolution",
    "status": "status",
}
FIGURES = (
    "order",
    "scheme",
    "threads",
    "wall_s",
    "steps",
    "particles",
    "particle_steps_per_s",
    "mass_drift",
    "lost",
    "momentum_imbalance",
    "energy_change_J",
    "energy_balance_J",
    "energy_scale_J",
    "energy_gain",
    "density_error",
    "density_max",
    "pressure_residual",
    "interface_residual",
)


def write_results(place: Place, results: dict, part: str) -> None:
    write_whole(place.out / f"results{part}.json", json.dumps(results, indent=1))
    text = io.StringIO(newline="")
    table = csv.writer(text)
    of_measure = ("name", "unit", "value", "target", "verdict")
    table.writerow([*COLUMNS.values(), "measure", *of_measure[1:], *FIGURES, "report", "command"])
    for r in results["rows"] + results["trials"]:
        for m in r["measures"]:
            percent = {k: 100 * m[k] for k in ("value", "target") if m["unit"] == "%" and m[k] is not None}
            shown = m | percent  # in the JSON a share is a share
            values = [*(r[k] for k in COLUMNS), *(shown[k] for k in of_measure), *(r.get(k) for k in FIGURES)]
            table.writerow([*values, r["report"], r["run"]])
    write_whole(place.out / f"results{part}.csv", text.getvalue())


def describe(row: dict) -> str:
    """One line of text about a run."""
    if row["status"] != "finished":
        return f"{row['id']}: {row['status']}: {row['message']}"
    figures = ", ".join(
        f"{m['name']} {measured(m['value'], m['unit'])}" + (f" ({m['verdict']})" if m["verdict"] != "no target" else "")
        for m in row["measures"]
    )
    notes = "".join(f" [{note}]" for note in dict.fromkeys(m["note"] for m in row["measures"] if m["note"]))
    return f"{row['id']}: {figures}; {row['wall_s']:.2f} s{notes}"


def carry_out(
    place: Place, jobs: list[Job], chosen: argparse.Namespace, references: list[Path], rows: list[dict]
) -> None:
    """Makes what is not finished, one at a time, and judges all: a row each, there as soon as it is known."""
    programs = build_hash(place)
    keys = {job.id: key_of(place, job, programs, chosen.repeats) for job in jobs}
    notes = {job.id: None if chosen.again else finished(place, job, keys[job.id]) for job in jobs}
    to_make = [job for job in jobs if notes[job.id] is None]
    with_picture = pictured(jobs)
    with tqdm(
        total=sum(EXPECTED[job.level] * chosen.repeats for job in to_make),
        disable=not sys.stderr.isatty(),
        bar_format="{l_bar}{bar}| {elapsed}, about {remaining} left{postfix}",
    ) as bar:
        made = 0
        for job in jobs:
            note = notes[job.id]
            if note is None:
                made += 1
                bar.set_postfix_str(f"run {made} of {len(to_make)}: {job.id}")
                note = make(place, job, keys[job.id], chosen.repeats, job.id in with_picture)
                bar.update(EXPECTED[job.level] * chosen.repeats)
            if job.id in with_picture and not (place.run_folder(job) / "start.png").is_file():
                draw_start(place, job)
            row = judge(place, job, note, references)
            if chosen.references and row["with_references"]:
                row["report"] += f" --references {shlex.quote(str(chosen.references))}"
            rows.append(row)
            tqdm.write(describe(row))


def results_of(rows: list[dict], trials: list[dict], chosen: argparse.Namespace, words: list[str], place: Place) -> dict:
    def one(key: str) -> str:
        return "; ".join(dict.fromkeys(str(r[key]) for r in rows + trials if key in r)) or "unknown"

    loads = [r["load"] for r in rows or trials]  # of those whose times are compared
    return {
        "written": datetime.datetime.now().astimezone().isoformat(timespec="minutes"),
        "level": chosen.level,
        "machine": one("machine"),
        "version": one("version"),
        "threads": " or ".join(dict.fromkeys(str(r["threads"]) for r in rows + trials if r.get("particles"))),
        "commit": commit(place.tree),
        "repeats": chosen.repeats,
        "load": [min(loads), max(loads)],
        "busy": max(loads) > compare.most_load(rows or trials),
        "wall_total": sum(w for r in rows + trials for w in r["walls"]),
        "command": shlex.join(["./launch/ballast", "report", *words]),
        "rows": rows,
        "trials": trials,
    }


@contextlib.contextmanager
def alone():
    """Two timed runs at once would slow each other down: one report at a time on a machine, as far as one user's go."""
    path = Path(tempfile.gettempdir()) / f"ballast_report.{os.getuid()}.lock"
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise Refused("another report is at work on this machine, and both would be slowed down: wait for it") from None
    try:
        yield
    finally:
        os.close(handle)


def main() -> int:
    words = sys.argv[1:]
    chosen = arguments(words)
    place = Place(Path(__file__).resolve().parents[2], chosen.build.resolve(), chosen.out.resolve())
    at = words.index("--build")
    words = words[:at] + words[at + 2 :]
    old = compare.load(chosen.against) if chosen.against else None
    jobs = choose(chosen)
    if chosen.list:
        programs = build_hash(place)
        for job in jobs:
            done = finished(place, job, key_of(place, job, programs, chosen.repeats))
            print(f"{job.id}  {job.level}  {done['status'] if done else 'to be made'}")
        return 0
    if not shutil.which("gnuplot"):
        raise Refused("gnuplot, which draws the charts, is not there: apt-get install gnuplot-nox")
    references = reference_folders(place, chosen.references)
    try:
        place.out.mkdir(parents=True, exist_ok=True)
    except OSError as why:
        raise Refused(f"--out: {place.out} cannot be made: {why.strerror}; give another folder") from None
    rows: list[dict] = []
    stopped = False
    with alone():
        try:
            carry_out(place, jobs, chosen, references, rows)
        except KeyboardInterrupt:
            stopped = True
            if not rows:
                raise
        made = len(rows)
        rows, trials = [r for r in rows if not r["trial"]], [r for r in rows if r["trial"]]
        cases: list[Case] = [case for case in ALL if any(job.case is case for job in jobs)]
        for case in cases:
            mark([r for r in rows if r["case"] == case.id])
        results = results_of(rows, trials, chosen, words, place)
        if stopped:  # results and page of all cases stay
            results["stopped"] = f"stopped after {made} of {len(jobs)} runs"
            write_results(place, results, "_part")
            where = place.out / "results_part.json"
            print(f"ballast report: {results['stopped']}; they are kept, the same command goes on; {where} and .csv", file=sys.stderr)
            return 5
        changes = compare.changes(old, results, str(chosen.against)) if old else None
        part = "_part" if chosen.cases or chosen.methods else ""  # the page of all cases stays
        write_results(place, results, part)
        path = page.write(place, cases, results, references, changes, part)
    counts = page.tally(rows)
    failed = sum(r["status"] != "finished" for r in rows)
    absent = counts["reference not installed"]
    print(
        f"{made} runs{f', {len(trials)} of them trials' if trials else ''}, {failed} not finished; {counts['met']} figures met, {counts['missed']} missed, "
        f"{absent} without reference{f' ({where_looked(references)})' if absent else ''}\n{path}"
    )
    if changes:
        print(compare.in_words(changes))
    return 3 if chosen.gate and (failed or counts["missed"] or counts["reference not installed"]) else 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C: the run at work is stopped, too
    try:
        sys.exit(main())
    except Refused as why:
        print(f"ballast report: {why}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # whoever read the lines has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(5)
    except KeyboardInterrupt:
        print("ballast report: stopped; the same command goes on", file=sys.stderr)
        sys.exit(5)
