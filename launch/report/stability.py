"""The stability suite: what may not blow up, leak or gain energy. One table; errors against exact answers are the cases' business."""

import numpy as np

from case import Case, Measure, Outcome, Variant
from cases_coupled import drift, largest_tilt

G = 9.81  # m/s^2, as in the scenes


def lost(run: Outcome) -> float:
    return run.record["particles"]["lost"]


def density_error(run: Outcome) -> float:
    return run.record["error"]["density_mean"]


def energy_gained(run: Outcome) -> float:
    """Of fluid and bodies together at the end over the start; over the kinetic energy at the start and a fall of all the
    fluid by a quarter of a metre. 0 where it is lost."""
    ledger = run.record["ledger"]
    energy, mass = ledger["energy_J"], ledger["mass_kg"]
    change = energy["change"] + energy.get("bodies_end", 0) - energy.get("bodies_start", 0)
    scale = mass * G * 0.25 * run.variant.values.get("gravity", 1) + run.variant.values.get("kinetic", 0)
    return max(0.0, change) / scale


def handed_over(run: Outcome) -> float:
    return run.record["ledger"]["imbalance_relative"] or 0.0


STABLE = (
    Measure("lost", "", lost, (0.0,)),
    Measure("density error", "%", density_error, (0.03,)),
    Measure("energy gained", "%", energy_gained, (0.01,)),
    Measure("given / received", "", handed_over, (1e-12,)),
)


def suite(
    case: str,
    title: str,
    about: str,
    variants: tuple[Variant, ...],
    scene: str = "report/tank_box",
    resolution: float = 0.025,
    more: tuple[Measure, ...] = (),
    methods: tuple[str, ...] = ("wcsph", "implicit"),
    overrides: dict[str, str] | None = None,
    to_the_limit: bool = False,
) -> Case:
    return Case(
        id=case,
        title=title,
        about=about,
        scene=scene,
        resolutions=(("10s", resolution),),
        measures=(*STABLE, *more),
        methods=methods,
        variants=variants,
        overrides=overrides or {},
        stability=True,
        to_the_limit=to_the_limit,
    )


def sweep(key: str, name: str, values: tuple, scale: float = 1) -> tuple[Variant, ...]:
    return tuple(Variant(f"{name}{v:g}", {key: f"{scale * v:g}"}) for v in values)


DENSITY, SIZE, SPEED = "models.box.density", "models.box.shape.box", "models.box.velocity"
LID = {"models.tank.shape.open_box.lid": "true"}  # so that what splashes out does not count as a leak
FLOATING = {"world.duration": "60", "output.every": "0.1"}


def heave_grows(run: Outcome) -> float:
    """Largest height or depth after the first second over the 0.1 m at the start, beyond 1."""
    return max(0.0, float(np.max(np.abs(run.values("box.z", 1) - 1))) / 0.1 - 1)


def wrong_way(run: Outcome) -> float:
    """Way against the one that buoyancy asks for, over the spacing."""
    z = run.values("box.z")
    way = (z[-1] - z[0]) * (1 if run["rises"] else -1)
    return max(0.0, float(-way)) / run.h


def thrown(speed: float) -> Variant:
    return Variant(
        f"{speed:g}ms",
        {"fluids.water.velocity": f"[{-speed:g}, 0, {-speed:g}]", "world.duration": f"{0.5 / speed:g}"},
        {"kinetic": 120 * speed**2},
    )


def shifted(x: float) -> Variant:
    return Variant(
        f"x{x:g}",
        {
            "models.tank.pose": f"[{x:.9g}, 0, 0]",
            "models.box.pose": f"[{x + 0.5:.9g}, 0, 0.25]",
            "fluids.water.fill.box": f"{{ min: [{x:.9g}, -0.5, 0], max: [{x + 1:.9g}, 0.5, 0.5] }}",
        },
    )


def sized(edge: float, rises: bool) -> Variant:
    """A box of `edge` spacings, a tenth or eight times as dense as the fluid."""
    return Variant(
        f"{edge:g}dx-{'light' if rises else 'heavy'}",
        {SIZE: f"[{0.025 * edge:g}, 1, {0.025 * edge:g}]", DENSITY: "100" if rises else "8000", "world.duration": "1"},
        {"rises": rises},
    )


CASES = (
    suite(
        "S01",
        "Density ratios",
        "box from a thousandth to twenty times as dense as the water",
        sweep(DENSITY, "r", (0.001, 0.01, 0.1, 0.5, 0.9, 1, 1.1, 2, 8, 20), 1000),
        methods=("wcsph", "implicit", "staggered"),
        overrides=LID,
    ),
    suite(
        "S06",
        "Viscosities",
        "0 to 1e4 Pa s, heavy box, a tenth of a second",
        sweep("fluids.water.viscosity", "mu", (0, 1e-6, 1e-3, 1, 60, 1e3, 1e4)),
        overrides={DENSITY: "2000", "world.duration": "0.1"},
    ),
    suite(
        "S08",
        "Sound speeds",
        "5 to 100 times 2.2 m/s",
        sweep("numerics.sound_speed", "c", (11, 22, 44, 88, 220)),
        methods=("wcsph",),
        overrides={"world.duration": "1"},
    ),
    suite(
        "S11",
        "Deep column",
        "150 layers, five wide, at rest for 3 s: pressure within 1 %",
        (Variant(),),
        scene="hydrostatic",
        resolution=0.02,
        more=(Measure("pressure, L2", "%", lambda r: r.mean("pressure_error", 1), (0.01,)),),
        overrides={
            "fluids.water.fill.box": "{ min: [0, -0.5, 0], max: [0.1, 0.5, 3] }",
            "models.tank.shape.open_box.inside": "[0.1, 1, 3.5]",
            "probes.level.level_at": "[0.05, 0]",
            "world.duration": "3",
        },
    ),
    suite(
        "S17",
        "Longer steps",
        "steps of 0.25 to 4 h / c: stable up to some limit, beyond it a stop that says so",
        sweep("numerics.courant", "C", (0.25, 0.5, 1, 1.5, 2, 3, 4)),
        methods=("wcsph",),
        to_the_limit=True,
    ),
    suite(
        "S20",
        "Hard impact",
        "box that hits the surface at 10 and 44.3 m/s (a fall from 100 m), tank with a lid",
        tuple(
            Variant(
                f"{v:g}ms",
                {"models.box.pose": "[0.5, 0, 0.62]", SPEED: f"[0, 0, {-v:g}]", "world.duration": "0.2"},
                {"kinetic": 20 * v**2},
            )
            for v in (10, 44.3)
        ),
        overrides=LID,
    ),
    suite(
        "S22",
        "Fast spin",
        "box that turns at 10 and 100 rad/s in the water",
        tuple(
            Variant(
                f"{w:g}",
                {"models.box.angular_velocity": f"[0, {w:g}, 0]", "world.duration": "0.5"},
                {"kinetic": 0.0667 * w**2},
            )
            for w in (10, 100)
        ),
    ),
    suite(
        "S23",
        "Bodies smaller than a spacing",
        "box of 0.5 to 2 spacings: moves the right way",
        tuple(sized(e, rises) for e in (0.5, 0.9, 2) for rises in (True, False)),
        more=(Measure("wrong way", "dx", wrong_way, (0.5,)),),
    ),
    suite(
        "S24",
        "Body as wide as the tank",
        "box with half a spacing to the walls on each side holds the water down like a piston",
        (Variant("", {SIZE: "[0.975, 1, 0.2]", "models.box.pose": "[0.5, 0, 0.4]"}),),
    ),
    suite(
        "S25",
        "Gravities",
        "none to a hundred times the earth's",
        tuple(
            Variant(
                f"{g:g}g",
                {"world.gravity": f"[0, 0, {-g * G:g}]", "world.duration": "1" if g < 10 else "0.2"},
                {"gravity": max(g, 1e-6)},
            )
            for g in (0, 1e-6, 0.1, 10, 100)
        ),
    ),
    suite(
        "S29",
        "Heave does not grow",
        "floating box let go 0.1 m too high, 20 s: never further away again",
        (Variant(),),
        scene="floating_box",
        resolution=0.1,
        more=(Measure("beyond the start", "%", heave_grows, (0.0,)),),
        methods=("wcsph", "implicit", "staggered"),
        overrides={"models.box.pose": "[1, 0, 1.1]", "world.duration": "20"},
    ),
    suite(
        "S36",
        "Long energy drift",
        "standing wave for 50 periods",
        (Variant(),),
        scene="report/standing_wave",
        resolution=0.1,
        overrides={"world.duration": "57", "output.every": "0.1"},
    ),
    suite(
        "S38",
        "Floating for a minute",
        "box at rest for 60 s: way under 5 % of its width, tilt under 2 degrees",
        (Variant(),),
        scene="floating_box",
        resolution=0.1,
        more=(
            Measure("way / width", "%", drift("box.x", 1), (0.05,)),
            Measure("tilt", "deg", largest_tilt, (2.0,)),
        ),
        overrides=FLOATING,
    ),
    suite(
        "S41",
        "Leaks",
        "water thrown into the corner of walls of one spacing at 5 to 50 m/s",
        tuple(thrown(v) for v in (5, 20, 50)),
        scene="report/water_on_wall",
    ),
    suite(
        "S43",
        "Far from the origin",
        "the tank shifted by 0, 10 and 100 km",
        tuple(shifted(x) for x in (0, 1e4, 1e5)),
        overrides={"world.duration": "1"},
    ),
)

# id, what, where it is looked at or why not
ELSEWHERE = (
    ("S02, S04", "hollow and thin bodies", "not built: a fill also fills the inside of a hollow body"),
    ("S05, S33, S35", "stacks, rest, many contacts", "R12, R12h, R6r and scenes/sunken_stack; not for 60 s in water"),
    ("S07", "set of the founding paper", "scenes/stacked_blocks; not with its viscosity and masses"),
    (
        "S09, S10, S46, S49",
        "exponents, contact stiffness, float against double, sample spacing",
        "no such choice exists",
    ),
    ("S12 to S16", "single, coincident and overlapping particles and bodies", "refused before the run; tests/faults"),
    ("S18", "exchange every n steps", "not built: every step is exchanged; lagged by one step: S01 staggered"),
    ("S19, S51", "late and killed processes, restart", "tests/faults"),
    ("S21, S27, S28, S34", "thin walls, squeezing, trapped particles, extremes of friction", "not built"),
    ("S30 to S32", "joints in water", "scenes/hinged_gate, R13; springs: B3; not built: motor, chain in a current"),
    ("S37", "a million steps of a closed system", "B11 with 10,000"),
    ("S39, S40", "nothing, only bodies, all fluid gone", "tests/launch; F8 lets fluid out"),
    ("S44, S45, S48", "scales, units, mirrors", "not built"),
    ("S47", "threads", "tests of the fluid: bit for bit"),
    ("S52", "bad input", "tests/faults"),
)
