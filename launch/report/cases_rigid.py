"""Bodies alone, free or on joints: the same engine adapter and the same command, without a fluid process."""

import functools
import math

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import NoFigure, crossings, extrema, period, relative
from references import first_flip, pendulum_period, tumbling

Array = np.ndarray
G = 9.81  # m/s^2, as in the scenes
STEPS = (("coarse", 4e-3), ("coarse", 2e-3), ("10s", 1e-3), ("1min", 5e-4))
STEP = "coupling.rigid_step"


def vectors(run: Outcome, body: str, of: str) -> Array:
    """Rows of three columns: of = "" position, "v" velocity, "w" angular velocity."""
    return np.stack([run.values(f"{body}.{of}{axis}") for axis in "xyz"], axis=1)


def rotations(run: Outcome, body: str) -> Array:
    """A rotation matrix a row, body to world."""
    w, x, y, z = (run.values(f"{body}.q{c}") for c in "wxyz")
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def spin_in_body(run: Outcome, body: str) -> Array:
    return np.einsum("tji,tj->ti", rotations(run, body), vectors(run, body, "w"))


def box_inertia(mass: float, edges: tuple[float, float, float]) -> Array:
    squares = np.square(edges)
    return mass / 12 * (squares.sum() - squares)


def energy(run: Outcome, body: str, mass: float, inertia: Array, g: float = G) -> Array:
    """Kinetic and potential, J."""
    v, w = vectors(run, body, "v"), spin_in_body(run, body)
    return mass * (np.square(v).sum(1) / 2 + g * run.values(f"{body}.z")) + (inertia * np.square(w)).sum(1) / 2


def largest(difference: Array) -> float:
    return float(np.max(np.abs(difference)))


# R1 and R2


def off_the_parabola(run: Outcome) -> float:
    """Largest distance from the exact path, m."""
    t = run.series("body.x")[0][:, None]
    start, speed = np.array([0, 0, 0]), np.array([run["vx"], 0, run["vz"]])
    return largest(vectors(run, "body", "") - (start + speed * t - np.array([0, 0, run["g"]]) * t**2 / 2))


ENDS = np.array([0, 10])  # s
FLIGHT = Case(
    id="R1",
    title="Free flight",
    scene="report/free_flight",
    about="A box flies at 1 m/s and turns about a principal axis at 1 rad/s for 10 s.",
    source="x = v t",
    knob=STEP,
    resolutions=STEPS,
    methods=("ode", "free_body"),
    variants=(Variant("", {}, {"vx": 1, "vz": 0, "g": 0}),),
    measures=(Measure("distance from the line / way", "", lambda r: off_the_parabola(r) / 10, (1e-9,)),),
    chart=Chart("t (s)", "x (m)", lambda r: r.series("body.x"), lambda v, f: (ENDS, ENDS), "v t"),
)
PROJECTILE = Case(
    id="R2",
    title="Projectile",
    scene="report/free_flight",
    about="The box thrown with (3, 4) m/s, for 1 s. A first-order step of 1 ms would err by 4.9 mm.",
    source="parabola",
    knob=STEP,
    resolutions=STEPS,
    methods=("ode", "free_body"),
    variants=(Variant("", {}, {"vx": 3, "vz": 4, "g": G}),),
    overrides={"world.gravity": "[0, 0, -9.81]", "world.duration": "1", "models.body.velocity": "[3, 0, 4]"},
    measures=(Measure("distance from the parabola", "m", off_the_parabola, (1e-6,)),),
    chart=Chart(
        "x (m)",
        "z (m)",
        lambda r: (r.values("body.x"), r.values("body.z")),
        lambda v, f: ((t := np.linspace(0, 1, 50)) * 3, 4 * t - G * t**2 / 2),
        "parabola",
    ),
)

# R3

PLATE = (math.sqrt(2), 1.0, 1e-4)  # m, and 12 kg: a flat plate's moments, 1, 2 and 3 kg m^2, to 1e-8
INERTIA = box_inertia(12, PLATE)
SPIN = (0.01, 1.0, 0.0)  # rad/s, about the three axes of the body


@functools.cache
def exact_spin() -> tuple[Array, Array]:
    t = np.arange(0, 100.001, 0.05)
    return t, tumbling(np.array([1.0, 2.0, 3.0]), np.array(SPIN), t, 0.05 / 3)[:, 1]


def flip(run: Outcome, number: int) -> float:
    ours = crossings(run.series("body.wx")[0], spin_in_body(run, "body")[:, 1])
    if ours.size < number:
        raise NoFigure(f"it flips {ours.size} times only")
    return abs(ours[number - 1] - (2 * number - 1) * first_flip((1, 2, 3), SPIN))


def turning_energy(run: Outcome, inertia: Array) -> Array:
    return (inertia * np.square(spin_in_body(run, "body"))).sum(1) / 2


def energy_drift(run: Outcome, inertia: Array) -> float:
    energy = turning_energy(run, inertia)
    return largest(energy / energy[0] - 1)


def spin_kept(run: Outcome) -> Array:
    """Magnitude of the angular momentum over that at the start."""
    size = np.linalg.norm(INERTIA * spin_in_body(run, "body"), axis=1)
    return size / size[0]


TUMBLING = Case(
    id="R3",
    title="Turning about the middle axis",
    scene="report/free_flight",
    about="A plate of 12 kg turns about its middle axis and flips over again and again (Dzhanibekov), for 100 s. It is 0.1 mm thick, so that its moments of inertia are 1, 2 and 3 kg m^2.",
    source="Euler's equations: flips at 1, 3, 5 ... quarter periods, by the elliptic integral",
    knob=STEP,
    resolutions=STEPS,
    methods=("ode", "free_body"),
    overrides={
        "world.duration": "100",
        "models.body.shape": f"{{ box: [{PLATE[0]:.17g}, {PLATE[1]}, {PLATE[2]}] }}",
        "models.body.velocity": "[0, 0, 0]",
        "models.body.angular_velocity": f"[{SPIN[0]}, {SPIN[1]}, {SPIN[2]}]",
    },
    measures=(
        Measure("time of the first flip", "s", lambda r: flip(r, 1), (0.1,)),
        Measure("time of the fifth flip", "s", lambda r: flip(r, 5), (1.0,)),
        Measure("energy drift", "%", lambda r: energy_drift(r, INERTIA), (1e-3,)),
        Measure("drift of the angular momentum", "%", lambda r: largest(spin_kept(r) - 1), (1e-3,)),
    ),
    chart=Chart(
        "t (s)",
        "spin about the middle axis (rad/s)",
        lambda r: (r.series("body.wx")[0], spin_in_body(r, "body")[:, 1]),
        lambda v, f: exact_spin(),
        "Euler's equations",
    ),
)

# R4

ROD = (1.5, 0.02)  # m, length and thickness
SMALL = (
    2 * math.pi * math.sqrt(((ROD[0] ** 2 + ROD[1] ** 2) / 12 + ROD[0] ** 2 / 4) / (G * ROD[0] / 2))
)  # s, of small swings


def rod_pose(degrees: float) -> str:
    """Pose of the rod that hangs on (0, 0, 2) at an angle from the vertical."""
    angle = math.radians(degrees)
    x, z = ROD[0] / 2 * math.sin(angle), 2 - ROD[0] / 2 * math.cos(angle)
    return f"[{x:.15g}, 0, {z:.15g}, 0, {math.pi / 2 - angle:.15g}, 0]"


def swings(run: Outcome) -> tuple[Array, Array]:
    """Angle from the vertical, rad."""
    t, x = run.series("rod.x")
    return t, np.unwrap(np.arctan2(x, 2 - run.values("rod.z")))


def amplitude_loss(run: Outcome) -> float:
    """Per period: from the first to the last extreme of the angle, over the periods between them."""
    _, top = extrema(*swings(run))
    return abs(abs(top[-1]) - abs(top[0])) / abs(top[0]) / ((top.size - 1) / 2)


def hinge_gap(run: Outcome) -> float:
    """Largest deviation of the distance from hinge to centre, over the rod's length."""
    return largest(np.hypot(run.values("rod.x"), run.values("rod.z") - 2) - ROD[0] / 2) / ROD[0]


ANGLES = np.arange(1.0, 160)  # degrees
PENDULUM = Case(
    id="R4",
    title="Pendulum",
    scene="report/pendulum",
    about="A rod of 1.5 m on a hinge, let go at 5 to 179 degrees, for 12 s (at 179 the target of the period is 1 %).",
    source="complete elliptic integral",
    knob=STEP,
    resolutions=STEPS,
    methods=("ode",),
    variants=tuple(
        Variant(f"{a}deg", {"models.rod.pose": rod_pose(a)}, {"angle": a}) for a in (5, 30, 60, 90, 120, 150, 179)
    ),
    measures=(
        Measure(
            "period",
            "%",
            lambda r: relative(period(*swings(r)), pendulum_period(SMALL, math.radians(r["angle"]))),
            lambda v: (1e-2,) if v.values["angle"] == 179 else (1e-3,),
        ),
        Measure("amplitude lost per period", "%", amplitude_loss, (1e-3,)),
        Measure("gap of the hinge / length", "", hinge_gap, (1e-4,)),
    ),
    chart=Chart(
        "angle (deg)",
        "period (s)",
        lambda r: (r["angle"], period(*swings(r))),
        lambda v, f: (ANGLES, np.array([pendulum_period(SMALL, math.radians(a)) for a in ANGLES])),
        joined=True,
    ),
)

# R13 and R14

LINK = box_inertia(0.1, (0.1, 0.02, 0.02))
LINKS = [f"link_{k}_0_0" for k in range(20)]


def chain_gap(run: Outcome) -> float:
    """Largest distance between ends that belong together, over the link's length."""
    worst = 0.0
    end = np.array([0, 0, 4.0])
    for name in LINKS:
        centre, along = vectors(run, name, ""), rotations(run, name)[:, :, 0] * 0.05
        worst = max(worst, float(np.max(np.linalg.norm(centre - along - end, axis=1))))
        end = centre + along
    return worst / 0.1


def chain_energy(run: Outcome) -> Array:
    return sum(energy(run, n, 0.1, LINK) for n in LINKS) + energy(run, "weight", 10, np.full(3, 0.4 * 10 * 0.1**2))


def gained(e: Array, scale: float) -> float:
    return max(0.0, float(np.max(e) - e[0])) / scale


CHAIN = Case(
    id="R13",
    title="Chain with a heavy end",
    scene="report/chain",
    about="Twenty links on ball joints with a weight of a hundred links, let go level, for 5 s.",
    source="conservation of energy",
    knob=STEP,
    resolutions=STEPS[1:],
    methods=("ode",),
    measures=(
        Measure("gap of a joint / link", "", chain_gap, (1e-3,)),
        Measure("energy gained / m g L", "%", lambda r: gained(chain_energy(r), 12 * G * 2), (0.01,)),
    ),
    chart=Chart(
        "t (s)",
        "energy change / m g L",
        lambda r: (r.series("weight.x")[0], (chain_energy(r) - chain_energy(r)[0]) / (12 * G * 2)),
        lambda v, f: (np.array([0, 5]), np.array([0, 0])),
        "none",
    ),
)
HANGING = [f"link_0_0_{k}" for k in range(20)]
BALANCES = (  # what is above, what is below, distance of their centres at the start (m), mass that hangs below (kg)
    (None, HANGING[0], -3.95, 12.0),
    (HANGING[9], HANGING[10], 0.1, 11.0),
    (HANGING[19], "weight", 0.15, 10.0),
)


def tension_error(run: Outcome) -> float:
    """Largest deviation of a spring's force from the weight below it over the last half second."""
    worst = 0.0
    for above, below, start, mass in BALANCES:
        apart = (run.values(f"{above}.z", 1.5) if above else 0) - run.values(f"{below}.z", 1.5)
        worst = max(worst, largest((apart - start) * 1e5 / (mass * G) - 1))
    return worst


TENSION = Case(
    id="R13t",
    title="Hanging chain: tension",
    scene="report/hanging_chain",
    about="The chain hangs at rest; springs of 1e5 N/m at its top, below the tenth link and above the weight give by what they bear. 0.1 % was chosen here.",
    source="what hangs below, m g",
    knob=STEP,
    resolutions=STEPS[1:],
    methods=("ode",),
    measures=(Measure("tension", "%", tension_error, (1e-3,)),),
)
BAR = box_inertia(1, (1, 0.02, 0.02))


def pendulum_energy(run: Outcome) -> Array:
    return energy(run, "upper", 1, BAR) + energy(run, "lower", 1, BAR)


DOUBLE_PENDULUM = Case(
    id="R14",
    title="Double pendulum",
    scene="report/double_pendulum",
    about="Two rods on hinges let go level, for 10 s: chaotic, but its energy stays.",
    source="conservation of energy",
    knob=STEP,
    resolutions=STEPS,
    methods=("ode",),
    measures=(
        Measure(
            "energy drift / m g L",
            "%",
            lambda r: largest(pendulum_energy(r) - pendulum_energy(r)[0]) / (2 * G),
            (0.01,),
        ),
    ),
    chart=Chart(
        "t (s)",
        "energy change / m g L",
        lambda r: (r.series("upper.x")[0], (pendulum_energy(r) - pendulum_energy(r)[0]) / (2 * G)),
        lambda v, f: (ENDS, np.array([0, 0])),
        "none",
    ),
)

CASES = (FLIGHT, PROJECTILE, TUMBLING, PENDULUM, CHAIN, TENSION, DOUBLE_PENDULUM)
