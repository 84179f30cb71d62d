"""Makes runs through the command `ballast run`, one at a time, and keeps those that are finished."""

import datetime
import hashlib
import json
import os
import re
import shlex
import shutil
import signal
import statistics
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from case import Job, Refused

PROGRAMS = ("ballast_coordinator", "fluid_server", "rigid_client")
EXPECTED = {"coarse": 3.0, "10s": 10.0, "1min": 60.0, "10min": 600.0}  # s of wall time, for the time left
BRIEFLY = (1e-9, 1e-4)  # s: one step; a few, where so short a one would throw particles that the layout pressed together
LIMIT = 20  # times what is expected: then a run is stopped and listed as such
STATUS = {
    0: "finished",
    2: "refused",
    3: "finished",
    4: "diverged",
    5: "failed",
}  # 3: an expectation of the scene missed


@dataclass(frozen=True)
class Place:
    """Where things are: the source tree, the programs, the results."""

    tree: Path
    build: Path
    out: Path

    def run_folder(self, job: Job) -> Path:
        return self.out / "runs" / job.id


def write_whole(path: Path, text: str) -> None:
    """A file that is whole or as it was before."""
    part = path.with_name(path.name + ".part")
    part.write_text(text, newline="")
    part.replace(path)


def build_hash(place: Place) -> str:
    digest = hashlib.sha256()
    for program in PROGRAMS:
        digest.update((place.build / "bin" / program).read_bytes())
    return digest.hexdigest()


def command(job: Job) -> list[str]:
    """Arguments of `./launch/ballast` that make this run from the root of the tree."""
    words = ["run", f"scenes/{job.scene}.yaml"]
    for path, value in job.overrides().items():
        words += ["--set", f"{path}={value}"]
    return words


def shown_command(job: Job) -> str:
    return shlex.join(["./launch/ballast", *command(job)])


def effective_scene(place: Place, job: Job) -> str:
    """The scene with every default written out; a scene that is refused is a mistake in the table of cases."""
    words = [str(place.build / "bin" / PROGRAMS[0]), "resolve", *command(job)[1:]]
    result = subprocess.run(words, cwd=place.tree, capture_output=True, text=True)
    if result.returncode != 0:
        raise Refused(f"the scene of {job.id} is refused\n{result.stderr}  {shown_command(job)}")
    return result.stdout


def key_of(place: Place, job: Job, programs: str, repeats: int) -> str:
    """What a finished run must have in common with the one wanted."""
    scene = effective_scene(place, job)
    parts = [scene, programs, os.environ.get("OMP_NUM_THREADS", ""), str(repeats)]
    for quoted, plain in re.findall(
        r'\bfile: (?:"([^"]+)"|([^\s,}]+))', scene
    ):  # the scene has the names of meshes only
        parts.append(hashlib.sha256(Path(quoted or plain).read_bytes()).hexdigest())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def finished(place: Place, job: Job, key: str) -> dict | None:
    """The note of a finished run with the same key, if there is one."""
    path = place.run_folder(job) / "run.json"
    if not path.is_file():
        return None
    note = json.loads(path.read_text())
    return note if note["key"] == key else None


def make(place: Place, job: Job, key: str, repeats: int, picture: bool) -> dict:
    """Runs it `repeats` times; outputs of the last, wall times of all. The note is written last, when all is there."""
    folder = place.run_folder(job)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "run.json").unlink(missing_ok=True)
    limit = LIMIT * EXPECTED[job.level]
    walls: list[float] = []
    note = {
        "key": key,
        "started": datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
        "load": round(os.getloadavg()[0], 2),
    }
    for _ in range(repeats):
        for name in ("record.json", "bodies.csv", "probes.csv", "picture.png", "start.png"):
            (folder / name).unlink(missing_ok=True)
        status, message = _run(place, job, folder, limit, picture)
        note |= {"status": status, "message": message}
        if status != "finished":
            break
        walls.append(json.loads((folder / "record.json").read_text())["wall_s"])
    note |= {"walls": walls, "wall_s": statistics.median(walls) if walls else None}
    write_whole(folder / "run.json", json.dumps(note, indent=1))
    return note


def draw_start(place: Place, job: Job) -> None:
    """start.png of the set-up: another run, of one step, that is not timed. What hinders it is in the run's log."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.png"
        for duration in BRIEFLY:
            words = [str(place.build / "bin" / PROGRAMS[0]), *command(job), "--set", f"world.duration={duration}"]
            words += ["--no-expect", "--quiet", "--picture", "--out", folder]
            with (place.run_folder(job) / "log.txt").open("a") as log:
                subprocess.run(words, cwd=place.tree, stdout=log, stderr=subprocess.STDOUT)
            if picture.is_file():
                shutil.copy(picture, place.run_folder(job) / "start.png")
                return


def _run(place: Place, job: Job, folder: Path, limit: float, picture: bool) -> tuple[str, str]:
    """One run; what became of it and, unless it finished, the message of `ballast`."""
    words = [str(place.build / "bin" / PROGRAMS[0]), *command(job), "--quiet", "--out", str(folder)]
    words += ["--picture"] if picture else []
    with (folder / "log.txt").open("w") as log:
        # In a group of its own: a Ctrl-C of the terminal comes to the report alone, which hands it on once. A second one would
        # kill the run, which may be drawing.
        process = subprocess.Popen(words, cwd=place.tree, stdout=log, stderr=subprocess.STDOUT, text=True, process_group=0)
        try:
            code = process.wait(limit)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            process.wait()
            return "stopped", f"stopped after {limit:g} s of wall time"
        except BaseException:  # Ctrl-C: the run is stopped as `ballast run` stops it, and is not kept
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
    status = STATUS.get(code, "failed")
    if status == "finished":
        return status, ""
    record = folder / "record.json"
    said = json.loads(record.read_text()).get("message") if record.is_file() else None
    return status, said or (folder / "log.txt").read_text().strip()[-400:]
