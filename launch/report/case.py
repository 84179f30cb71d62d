"""What a validation case is: a scene, what is varied, what is measured, what it is compared with."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from metrics import NoFigure

Array = np.ndarray

LEVELS = ("coarse", "10s", "1min", "10min")  # what a run may cost on two cores; coarse ones only show the order
TRIALS_FROM = "1min"


class Refused(Exception):
    """What was asked for cannot be done: what, the value seen, what to do. Exit code 2."""


@dataclass(frozen=True)
class Method:
    """One way to compute the same scene: overrides of its keys, and what it is in a few words."""

    name: str
    overrides: dict[str, str]
    about: str


METHODS = {
    m.name: m
    for m in (
        Method(
            "wcsph",
            {"numerics.pressure": "wcsph"},
            "explicit, weakly compressible: the pressure follows the compression at a finite speed of sound",
        ),
        Method(
            "implicit",
            {"numerics.pressure": "implicit"},
            "the pressure that leaves no compression, from one linear system a step, bodies included; longer steps",
        ),
        Method(
            "wide",
            {"numerics.pressure": "wcsph", "numerics.support": "4"},
            "the explicit solver with a kernel of 4 instead of 2.9 spacings: twice the neighbours in 2-D, quieter particles",
        ),
        Method(
            "staggered",
            {"numerics.pressure": "wcsph", "coupling.scheme": "staggered"},
            "the explicit solver with forces that know only the bodies' last acceleration, to show where that fails",
        ),
        Method("ode", {"coupling.engine": "ode"}, "bodies alone, by the Open Dynamics Engine"),
        Method("free_body", {"coupling.engine": "free_body"}, "bodies alone, by an engine without contacts and joints"),
    )
}


@dataclass(frozen=True)
class Variant:
    """One value of what a case sweeps, such as a density ratio: overrides, and the numbers that measures need. `without`:
    resolutions of the case at which it is not run, as it has no target there."""

    name: str = ""
    overrides: dict[str, str] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    without: tuple[float, ...] = ()


class Outcome:
    """A finished run as measures see it: its record and the columns of bodies.csv and probes.csv."""

    def __init__(self, folder: Path, h: float, variant: Variant, references: list[Path]):
        self.record = json.loads((folder / "record.json").read_text())
        self.folder, self.h, self.variant, self._references = folder, h, variant, references
        self.asked_for_references = False
        self._columns: dict[str, Array] = {}
        self._times: dict[str, Array] = {}
        for name in ("bodies.csv", "probes.csv"):
            path = folder / name
            if not path.is_file():
                continue
            with path.open() as file:
                names = file.readline().strip().split(",")
                values = np.loadtxt(file, delimiter=",", ndmin=2)
            for index, column in enumerate(names[1:], 1):
                self._columns[column], self._times[column] = values[:, index], values[:, 0]

    @property
    def references(self) -> list[Path]:
        self.asked_for_references = True
        return self._references

    def __getitem__(self, value: str) -> float:
        return self.variant.values[value]

    def beside(self, variant: Variant | None = None, h: float | None = None) -> "Outcome":
        """The run by the same method that differs in its variant, its resolution or both."""
        variant, h = variant or self.variant, h or self.h
        by_method = self.folder.parent
        folder = (by_method if variant is self.variant else by_method.parent.with_name(variant.name) / by_method.name) / f"{h:g}"
        if not (folder / "record.json").is_file():
            raise NoFigure(f"the run {variant.name} at {h:g} beside it is not there")
        return Outcome(folder, h, variant, self._references)

    def series(self, column: str, start: float = 0, stop: float = np.inf) -> tuple[Array, Array]:
        """Times and values of a column within a window of time."""
        if column not in self._columns:
            raise NoFigure(f"the run has no column {column}")
        t, y = self._times[column], self._columns[column]
        inside = (t >= start - 1e-9) & (t <= stop + 1e-9)
        if not inside.any():
            raise NoFigure(f"no row of {column} lies between {start:g} and {stop:g} s")
        return t[inside], y[inside]

    def values(self, column: str, start: float = 0, stop: float = np.inf) -> Array:
        return self.series(column, start, stop)[1]

    def lost(self) -> float:
        """Share of the particles that left the domain or ended inside a solid."""
        particles = self.record["particles"]
        return particles["lost"] / (particles["fluid"] + particles["left_domain"])

    def mean(self, column: str, start: float = 0, stop: float = np.inf) -> float:
        return float(self.values(column, start, stop).mean())


@dataclass(frozen=True)
class Measure:
    """An error, the smaller the better. unit "%" shows a share as percent; targets are for 10s, 1min, 10min, and may
    depend on the variant."""

    name: str
    unit: str
    value: Callable[[Outcome], float]
    targets: tuple[float, ...] | Callable[[Variant], tuple[float, ...]] = ()

    def targets_of(self, variant: Variant) -> tuple[float, ...]:
        return self.targets(variant) if callable(self.targets) else self.targets

    def target(self, variant: Variant, level: str) -> float | None:
        targets = self.targets_of(variant)
        if not targets or level == "coarse":
            return None
        return targets[min(LEVELS.index(level) - 1, len(targets) - 1)]


# Of tanks that are open on top, without a target: spray leaps over their walls. None is lost from closed ones, as the
# stability suite holds them to.
LOST = Measure("particles lost / all", "%", Outcome.lost)


def judged_at(targets: tuple[float, ...], **values: float) -> Callable[[Variant], tuple[float, ...]]:
    """Targets of a measure for the variants that have these values; for the others it only shows something."""
    return lambda variant: targets if values.items() <= variant.values.items() else ()


@dataclass(frozen=True)
class Chart:
    """Run and reference in one picture. A run gives a curve, or (joined) one point of a curve over the variants."""

    x: str
    y: str
    run: Callable[[Outcome], tuple[Array, Array] | tuple[float, float]]
    reference: Callable[[Variant, list[Path]], tuple[Array, Array]] | None = None
    reference_name: str = "exact"
    joined: bool = False
    points: bool = False  # the reference is a few measured points, not a curve
    log_x: bool = False


@dataclass(frozen=True)
class Trial:
    """A run with something changed, to find out what an error comes from. Not judged; made from the level 1min on."""

    name: str  # in its id, behind a plus: X2/wcsph/0.01+viscous
    changed: str  # in a few words
    runs: tuple[str, ...]  # what is changed, such as r0.01/wcsph/0.01; a resolution of its own may stand there
    overrides: dict[str, str] = field(default_factory=dict)
    scene: str = ""  # instead of the case's, for what no override can change
    values: dict[str, float] = field(default_factory=dict)  # of its variant, instead of the case's


@dataclass(frozen=True)
class Finding:
    """What was found out by looking: why a case misses its targets, why an observed order is below 1, each a sentence or a few
    per line. Figures in them are fields that reasons.py fills in from the results, the trials' among them."""

    why: str = ""
    order_why: str = ""
    trials: tuple[Trial, ...] = ()


@dataclass(frozen=True)
class Case:
    """knob is the key that the resolutions set: the particle spacing, or the step of the rigid engine."""

    id: str
    title: str
    about: str
    scene: str
    resolutions: tuple[tuple[str, float], ...]  # (level, value of the knob), coarse to fine
    measures: tuple[Measure, ...]
    methods: tuple[str, ...] = ("wcsph", "implicit")
    variants: tuple[Variant, ...] = (Variant(),)
    chart: Chart | None = None
    second_chart: Chart | None = None
    shown: tuple[int, ...] | None = None  # which variants the charts show; None: all
    knob: str = "world.spacing"
    overrides: dict[str, str] = field(default_factory=dict)
    source: str = ""
    finding: Finding = Finding()
    stability: bool = False  # a line of the stability table, not a section of its own
    beside: Callable[["Job"], tuple[Variant, float]] | None = None  # variant and resolution of the run its figures need
    to_the_limit: bool = False  # a clean stop with code 4 counts as what is wanted beyond some limit

    @property
    def charts(self) -> list[Chart]:
        return [chart for chart in (self.chart, self.second_chart) if chart]

    @property
    def unit(self) -> str:
        return "m" if self.knob == "world.spacing" else "s"


@dataclass(frozen=True)
class Job:
    """One run to make: its id is case[/variant]/method/resolution, such as B4/r0.01/wcsph/0.005."""

    case: Case
    variant: Variant
    method: str
    level: str
    h: float
    trial: Trial | None = None

    @property
    def base(self) -> str:
        """Its id without what a trial changes."""
        return "/".join(x for x in (self.case.id, self.variant.name, self.method, f"{self.h:g}") if x)

    @property
    def id(self) -> str:
        return f"{self.base}+{self.trial.name}" if self.trial else self.base

    @property
    def group(self) -> str:
        """What it is compared with over resolutions: the same case, variant and method."""
        return "/".join(x for x in (self.case.id, self.variant.name, self.method) if x)

    @property
    def scene(self) -> str:
        return self.trial.scene if self.trial and self.trial.scene else self.case.scene

    def overrides(self) -> dict[str, str]:
        return {
            self.case.knob: f"{self.h:g}",
            **self.case.overrides,
            **METHODS[self.method].overrides,
            **self.variant.overrides,
            **(self.trial.overrides if self.trial else {}),
        }


def jobs_of(case: Case, upto: str, methods: set[str] | None) -> list[Job]:
    """The runs of a case up to a level, cheap ones first, and its trials."""
    allowed = LEVELS[: LEVELS.index(upto) + 1]
    judged = [
        Job(case, variant, method, level, h)
        for level, h in case.resolutions
        if level in allowed
        for method in case.methods
        if methods is None or method in methods
        for variant in case.variants
        if h not in variant.without
    ]
    trials = [_trial_of(case, trial, run) for trial in case.finding.trials for run in trial.runs]
    return judged + [job for job in trials if job.level in allowed and (methods is None or job.method in methods)]


def _trial_of(case: Case, trial: Trial, run: str) -> Job:
    *variant, method, h = run.split("/")
    of = {v.name: v for v in case.variants}[variant[0] if variant else ""]
    return Job(case, replace(of, values={**of.values, **trial.values}), method, TRIALS_FROM, float(h), trial)


def with_those_beside(wanted: list[Job], everything: list[Job]) -> list[Job]:
    """The runs wanted, those that their figures need and those that trials change, in the order of all."""
    needed = {job.id for job in wanted} | {job.base for job in wanted if job.trial and (job.trial.overrides or job.trial.scene)}
    for job in wanted:
        if job.case.beside:
            variant, h = job.case.beside(job)
            needed.add(replace(job, variant=variant, h=h, trial=None).id)
    return [job for job in everything if job.id in needed]
