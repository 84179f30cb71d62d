"""Cases of bodies that only the fluid drives, with an exact answer."""

import math
from collections.abc import Callable

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import NoFigure, first_row, relative, slope
from references import added_mass, released, rest_angle

G = 9.81  # m/s^2, as in the scenes


def drift(column: str, start: float) -> Callable[[Outcome], float]:
    return lambda run: float(np.max(np.abs(run.values(column) - start)))


def largest_tilt(run: Outcome) -> float:
    return float(np.degrees(2 * np.max(np.abs(run.values("box.qy")))))


FLOATING_BOX = Case(
    id="B1",
    title="Floating box: draft, drift, noise",
    scene="floating_box",
    about="A box of 1 x 0.5 m and half the water's density floats in 2-D, set in at its exact draft, for 10 s.",
    source="Archimedes",
    resolutions=(("coarse", 0.1), ("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125)),
    measures=(
        Measure("mean draft over the last half", "dx", lambda r: abs(r.mean("box.z", 5) - 1) / r.h, (0.2, 0.1, 0.1)),
        Measure("sideways drift / width", "%", drift("box.x", 1), (0.02, 0.01, 0.005)),
        Measure("rms heave", "dx", lambda r: float(np.std(r.values("box.z", 5))) / r.h, (0.05, 0.02, 0.01)),
        Measure("largest tilt", "deg", largest_tilt, (1,)),
    ),
    methods=("wcsph", "implicit", "wide", "staggered"),
    chart=Chart(
        "t (s)",
        "height of the centre (m)",
        lambda r: r.series("box.z"),
        lambda v, f: (np.array([0, 10]), np.array([1, 1])),
        "Archimedes",
    ),
)

TURNED = math.degrees(rest_angle(0.7))


def heel(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Angle by which the box has turned, degrees."""
    t, y = run.series("box.qy")
    return t, np.degrees(np.unwrap(2 * np.arctan2(y, run.values("box.qw"))))


def at_rest(run: Outcome) -> float:
    t, angle = heel(run)
    return abs(float(angle[t >= 15].mean()) - TURNED)


def growth(run: Outcome) -> float:
    """s of angle = start cosh(s t), from the time at which it is three times that at the start, 1/s."""
    t, angle = heel(run)
    beyond = first_row(angle > 3 * angle[0], "the box does not roll to three times the angle at the start")
    return math.acosh(3) / float(np.interp(3 * angle[0], angle[: beyond + 1], t[: beyond + 1]))


ROLLING_BOX = Case(
    id="B1r",
    title="Floating box that rolls over",
    scene="report/roll_over",
    about="A box of 1 x 1 m, 0.7 times as dense as water, which is not stable upright (metacentric height -3.1 cm), is let go 3 degrees off upright in a tank 3 m wide and 2 m deep, for 20 s: "
    "the box of another code's record. It rolls to 45 degrees, at about 1 1/s in the beginning. Shown without a target: at 45 degrees the metacentric height is 1 cm only, "
    "so that a lever of a third of a millimetre turns it by 2 degrees.",
    source="hydrostatics",
    resolutions=(("coarse", 0.1), ("10s", 0.05), ("1min", 1 / 30), ("10min", 0.025)),
    measures=(
        Measure("mean angle from 15 s on, against 45", "deg", at_rest),
        Measure("growth in the beginning against 1 1/s", "%", lambda r: abs(growth(r) - 1)),
    ),
    chart=Chart(
        "t (s)", "angle (degrees)", heel, lambda v, f: (np.array([0, 20]), np.array([TURNED, TURNED])), "stable"
    ),
)

RATIOS = (0.001, 0.01, 0.1, 0.5, 0.9, 1.1, 2, 8, 20)  # of the body's density to the fluid's


RADIUS = 0.1  # m, of the bodies


def first_acceleration(run: Outcome, radii: float = 0.03) -> float:
    """Downwards, over g: slope of the velocity from when sound has gone five times as far as the container's radius
    until the body has moved by some radii."""
    t, z = run.series("body.z")
    moved = np.nonzero(np.abs(z - z[0]) > radii * RADIUS)[0]
    return -slope(*run.series("body.vz", 5 * run["wider"] * RADIUS / run["sound"], t[moved[0]] if moved.size else t[-1])) / G


def moved_by_then(ratio: float, coefficient: float, longest: float) -> str:
    """How long a run must be for that, with something to spare; s."""
    exact = abs(float(released(np.array(ratio), coefficient))) * G
    return f"{min(1.1 * math.sqrt(0.06 * RADIUS / exact), longest):.3g}"


def release(
    shape: str,
    scene: str,
    case: str,
    title: str,
    resolutions: tuple,
    longest: float,
    methods: tuple,
    wider: int = 2,
    sound: float = 80,
    sweep: tuple = RATIOS,
    overrides: dict[str, str] = {},
) -> Case:
    coefficient = added_mass(shape, wider)
    ratios = np.geomspace(sweep[0], sweep[-1], 200)

    def off(radii: float) -> Callable[[Outcome], float]:
        return lambda run: relative(first_acceleration(run, radii), float(released(np.array(run["ratio"]), coefficient)))

    return Case(
        id=case,
        title=title,
        scene=scene,
        about=f"A {shape} let go in a concentric container {'twice' if wider == 2 else f'{wider} times'} as wide, full of water, at density ratios {sweep[0]:g} to "
        f"{sweep[-1]:g}: a = g (r - 1) / (r + {coefficient:.4f}). Without its added mass the lightest would start with {1 - 1 / sweep[0]:.0f} g.",
        source="Lamb, Hydrodynamics, art. 93",
        resolutions=resolutions,
        measures=(
            Measure("first acceleration", "%", off(0.03), (0.08, 0.04, 0.02)),
            Measure("until 0.01 radii", "%", off(0.01)),
        ),
        methods=methods,
        variants=tuple(
            Variant(
                f"r{r:g}",
                {
                    "models.body.density": f"{1000 * r:g}",
                    "world.duration": moved_by_then(r, coefficient, longest),
                },
                {"ratio": r, "wider": wider, "sound": sound},
            )
            for r in sweep
        ),
        overrides={"numerics.sound_speed": f"{sound:g} m/s"} | overrides,
        chart=Chart(
            "density of the body / of the fluid",
            "first acceleration downwards / g",
            lambda r: (r["ratio"], first_acceleration(r)),
            lambda v, f: (ratios, released(ratios, coefficient)),
            "Lamb, art. 93",
            joined=True,
            log_x=True,
        ),
    )


RELEASE_2D = release(
    "cylinder",
    "added_mass_2d",
    "B4",
    "Release from rest in 2-D: added mass",
    (("coarse", 0.02), ("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
    1,
    ("wcsph", "implicit", "staggered"),
)
RELEASE_WIDE = release(
    "cylinder",
    "added_mass_2d",
    "B4w",
    "Release from rest in 2-D, wider container: added mass",
    (("coarse", 0.02), ("10s", 0.01), ("1min", 0.005)),
    0.05,
    ("wcsph", "implicit"),
    wider=5,
    sound=200,
    overrides={
        "models.shell.shape": "{ hollow_cylinder: { radius: 0.5, length: 1, wall: 0.05 } }",
        "fluids.water.fill": "{ level: { container: shell, z: 0.5 } }",
    },
)
RELEASE_3D = release(
    "sphere",
    "added_mass_3d",
    "B4s",
    "Release from rest in 3-D: added mass",
    (("coarse", 0.025), ("10s", 0.0125), ("1min", 0.01), ("10min", 0.005)),
    0.04,
    ("wcsph", "implicit"),
)


def way(run: Outcome) -> float:
    x, z = run.values("disc.x") - 0.5, run.values("disc.z") - 0.5
    return float(np.max(np.hypot(x, z)))


NEUTRAL = Case(
    id="B10",
    title="Neutral buoyancy: drift",
    scene="neutral",
    about="A disc of the water's own density, 0.2 m wide, at rest in mid-depth for 10 s. It stays.",
    source="no motion",
    resolutions=(("coarse", 0.05), ("coarse", 0.025), ("10s", 0.0125), ("1min", 0.00625)),
    measures=(Measure("largest way / diameter", "%", lambda r: way(r) / 0.2, (0.01, 0.003, 0.001)),),
    chart=Chart(
        "t (s)",
        "height of the centre (m)",
        lambda r: r.series("disc.z"),
        lambda v, f: (np.array([0, 10]), np.array([0.5, 0.5])),
        "no motion",
    ),
)


def cube_way(run: Outcome) -> float:
    return float(np.max(np.sqrt(sum(np.square(run.values(f"cube.{c}") - 0.25) for c in "xyz"))))


NEUTRAL_CUBE = Case(
    id="B10c",
    title="Neutral buoyancy: a cube in 3-D",
    scene="report/neutral_cube",
    about="A cube of 0.2 m and the water's density at rest in the middle of 0.5 x 0.5 x 0.5 m of water for 10 s, four and eight spacings across. It stays.",
    source="no motion",
    resolutions=(("10s", 0.05), ("1min", 0.025)),
    measures=(Measure("largest way / edge", "%", lambda r: cube_way(r) / 0.2, (0.01, 0.003, 0.001)),),
    chart=Chart(
        "t (s)",
        "height of the centre (m)",
        lambda r: r.series("cube.z"),
        lambda v, f: (np.array([0, 10]), np.array([0.25, 0.25])),
        "no motion",
    ),
)


def radius(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Of the way of the disc's centre, m."""
    t, x = run.series("disc.x")
    return t, np.hypot(x, run.values("disc.z"))


def radius_drift(run: Outcome) -> float:
    return float(np.max(np.abs(radius(run)[1] - 0.25)))


def round_about(run: Outcome) -> float:
    """Mean rate at which its centre goes round, rad/s."""
    t, x = run.series("disc.x")
    angle = np.unwrap(np.arctan2(-run.values("disc.z"), x))
    return float((angle[-1] - angle[0]) / (t[-1] - t[0]))


TURNING = Case(
    id="B10r",
    title="Neutral buoyancy: turning with the water",
    scene="report/carousel",
    about="The disc 0.25 m off the centre of a round tank of 1 m, full, that turns at 1 rad/s with all that is in it, for 10 s, without gravity. It goes on to turn with it: "
    "radius of its way, rate at which its centre goes round, rate at which it turns itself at the end.",
    source="rigid rotation",
    resolutions=(("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125)),
    measures=(
        Measure("radius, drift / diameter", "%", lambda r: radius_drift(r) / 0.2, (0.01, 0.003, 0.001)),
        Measure("rate of going round", "%", lambda r: abs(round_about(r) - 1)),
        Measure("rate of turning", "%", lambda r: abs(float(r.values("disc.wy")[-1]) - 1)),
    ),
    chart=Chart(
        "t (s)",
        "radius (m)",
        radius,
        lambda v, f: (np.array([0, 10]), np.array([0.25, 0.25])),
        "rigid rotation",
    ),
)


def effective_density(run: Outcome) -> float:
    """At which the disc would neither rise nor sink, over the water's: what the water bears, over g and its volume."""
    return run.mean("disc.fz", 1) / (1000 * G * math.pi * 0.1**2)


HELD = Case(
    id="B10d",
    title="Neutral buoyancy: effective density",
    scene="report/held_disc",
    about="The same disc, held at four places of the lattice; the force of the water on it says at which density it would stay where it is.",
    source="Archimedes",
    resolutions=(("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125)),
    measures=(Measure("effective density", "%", lambda r: abs(effective_density(r) - 1), (0.02, 0.01, 0.005)),),
    variants=tuple(
        Variant(name, {"models.disc.pose": f"[{0.5 + x}, 0, {0.5 + z}]"})
        for name, x, z in (("centred", 0, 0), ("right", 0.004, 0), ("above", 0, 0.003), ("aslant", 0.0025, -0.0055))
    ),
)


def momentum_drift(run: Outcome) -> float:
    """The scene's own expectation: change of the momentum of fluid and bodies over the sum of all at the start."""
    return next(e["value"] for e in run.record["expect"] if e["name"] == "drift of total momentum")


SOLIDS = {"a": 500 * 0.2**3, "b": 2000 * 0.2**3, "c": 1000 * 4 / 3 * math.pi * 0.1**3}  # kg


def momentum_in_time(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Change since the first row of the momentum of fluid and bodies together, over the sum of all at the start."""
    t = run.series("motion.px")[0]
    total, size = np.zeros((t.size, 3)), 0.0
    for mass, column in ((1, "motion.p"), *((m, f"{name}.v") for name, m in SOLIDS.items())):
        part = mass * np.transpose([run.values(column + axis) for axis in "xyz"])
        total, size = total + part, size + float(np.linalg.norm(part[0]))
    return t, np.linalg.norm(total - total[0], axis=1) / size


def without_fluid(run: Outcome, masses: dict[str, float]) -> dict[str, np.ndarray]:
    """What contacts and joints have given each body, N s: its change of momentum less what it received from the fluid."""
    given = run.record["ledger"]["per_body_N_s"]
    velocity = {name: np.transpose([run.values(f"{name}.v{axis}") for axis in "xyz"]) for name in masses}
    return {name: m * (velocity[name][-1] - velocity[name][0]) - np.array(given[name]) for name, m in masses.items()}


def contacts_balance(run: Outcome) -> float:
    parts = np.array(list(without_fluid(run, SOLIDS).values()))
    return float(np.linalg.norm(parts.sum(axis=0)) / np.linalg.norm(parts, axis=1).sum())


def never_hit(run: Outcome, name: str, masses: dict[str, float]) -> float:
    """0 if contacts have given a body without joints more than a tenth of its momentum at the start, else 1."""
    start = masses[name] * np.array([run.values(f"{name}.v{axis}")[0] for axis in "xyz"])
    return float(np.linalg.norm(without_fluid(run, masses)[name]) < 0.1 * np.linalg.norm(start))


CLOSED_BOX = Case(
    id="B11",
    title="Closed system: momentum",
    scene="closed_box",
    about="A periodic box without gravity, water and three bodies, two of them joined, the third thrown at them: more than 10,000 steps. What contacts and joints have "
    "given a body is its change of momentum less what it received from the fluid; all of it together is nothing. Angular momentum: B11d.",
    source="conservation; single precision in the fluid",
    resolutions=(("coarse", 0.08), ("10s", 0.05), ("1min", 0.04)),
    measures=(
        Measure("drift of total momentum", "", momentum_drift, (1e-5,)),
        Measure("given against received", "", lambda r: r.record["ledger"]["imbalance_relative"], (1e-12,)),
        Measure("contacts and joints, sum over sizes", "", contacts_balance, (1e-12,)),
        Measure("sphere never hit (0: it was)", "", lambda r: never_hit(r, "c", SOLIDS), (0,)),
    ),
    methods=("wcsph",),
    chart=Chart(
        "t (s)",
        "drift of total momentum / momenta at the start",
        momentum_in_time,
        lambda v, f: (np.array([0, 100]), np.array([0, 0])),
        "constant",
    ),
)

CASES = (FLOATING_BOX, ROLLING_BOX, RELEASE_2D, RELEASE_WIDE, RELEASE_3D, NEUTRAL, NEUTRAL_CUBE, TURNING, HELD, CLOSED_BOX)
