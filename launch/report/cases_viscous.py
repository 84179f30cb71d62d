"""Bodies that only a viscous fluid drives: shear, torque, drag, and viscous damping of a swing."""

import math
from dataclasses import replace

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import decay_rate, nrmse, period, relative, resample
from references import annulus_spin_down, plate_between_walls, read_table

Array = np.ndarray
COUPLED = ("wcsph", "implicit")

# B3

VIBRATION = "annulus_spring_cylinder_free_vibration.csv"
MASS = 1000 * math.pi * 0.1**2  # kg/m, of the displaced fluid
RATIOS = 0.01, 0.1, 0.5, 1, 2, 8


def vibration(values: dict[str, float], folders: list) -> tuple[float, float]:
    """Frequency (Hz) and decay rate (1/s) of a variant (Chen, Wambsganss and Jendrzejczyk 1976)."""
    table = read_table(VIBRATION, folders)
    row = np.nonzero(np.isclose(table["nu"], values["nu"]) & np.isclose(table["density_ratio"], values["ratio"]))[0][0]
    return float(table["f"][row]), float(table["s"][row])


def frequency(run: Outcome) -> float:
    """Over periods 2 to 4, after the early transient."""
    return 1 / period(*run.series("body.x"), first=2, count=6)


def damping(run: Outcome) -> float:
    return decay_rate(*run.series("body.x"), first=1, count=7)


def frequency_error(run: Outcome) -> float:
    return relative(frequency(run), vibration(run.variant.values, run.references)[0])


def damping_error(run: Outcome) -> float:
    return relative(damping(run), vibration(run.variant.values, run.references)[1])


def damped(v: Variant, folders: list) -> tuple[Array, Array]:
    f, s = vibration(v.values, folders)
    t = np.linspace(0, 5, 400)
    return t, 0.004 * np.exp(-s * t) * np.cos(2 * math.pi * f * t)


def spring(ratio: float, nu: float = 1e-4) -> Variant:
    k = (2 * math.pi) ** 2 * (ratio + 5 / 3) * MASS
    return Variant(
        f"r{ratio:g}" + (f"-nu{nu:g}" if nu != 1e-4 else ""),
        {
            "models.body.density": f"{1000 * ratio:g}",
            "joints.spring.spring": f"{k:.7g}",
            "fluids.water.viscosity": f"{1000 * nu:g}",
        },
        {"ratio": ratio, "nu": nu},
    )


SPRING = Case(
    id="B3",
    title="Cylinder on a spring in an annulus",
    scene="report/spring_annulus",
    about="A cylinder of 0.2 m on a spring in a concentric container twice as wide, viscosity 1e-4 m^2/s: added mass and viscous "
    "damping together, at density ratios 0.01 to 8. Frequency and decay over periods 2 to 4.",
    source="S.S. Chen, M.W. Wambsganss, J.A. Jendrzejczyk, J. Appl. Mech. 43 (1976) 325-329, evaluated for this project",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
    measures=(
        Measure("frequency", "%", frequency_error, (0.03, 0.015, 0.007)),
        Measure("decay rate", "%", damping_error, (0.25, 0.15, 0.08)),
    ),
    methods=COUPLED,
    variants=tuple(spring(r) for r in RATIOS),
    shown=(1,),
    chart=Chart("t (s)", "x (m)", lambda r: r.series("body.x"), damped, "Chen et al. 1976"),
)
SPRING_VISCOSITIES = replace(
    SPRING,
    id="B3n",
    title="Cylinder on a spring in an annulus: other viscosities",
    about="B3 with ten times and a tenth of its viscosity, without a target. At 1e-3 m^2/s light cylinders do not swing for four periods. 1e-5 m^2/s asks for 40 spacings per radius "
    "(level 10min); at 10 the explicit runs of the two lightest are stopped after 4.7 s, when the fluid has gained 13 and 15 % of its energy (numerics.energy_bound).",
    resolutions=(("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
    measures=(Measure("frequency", "%", frequency_error), Measure("decay rate", "%", damping_error)),
    variants=tuple(spring(r, nu) for nu in (1e-3, 1e-5) for r in RATIOS),
    shown=(1,),
)

# B5 and B6


def against(run: Outcome, column: str, start: float, exact, until: float) -> float:
    """NRMSE of a speed over its value at the start, on times 0.05 s apart."""
    at = np.arange(0.05, until + 1e-9, 0.05)
    t, y = run.series(column)
    return nrmse(resample(t, y / start, at), exact(run["ratio"], at))


def turning_lost(run: Outcome) -> float:
    """Change of the angular momentum of fluid and cylinder, and what the wall was given, over that at the start."""
    ledger, inertia = run.record["ledger"], 1000 * run["ratio"] * math.pi * 0.1**4 / 2
    body = inertia * run.values("body.wy")
    fluid = ledger["angular_momentum_end_N_m_s"][1] - ledger["angular_momentum_start_N_m_s"][1]
    return abs(float(body[-1] - body[0]) + fluid + ledger["angular_per_model_N_m_s"]["shell"][1]) / float(body[0])


def fading(
    case: str,
    title: str,
    scene: str,
    about: str,
    column: str,
    label: str,
    start: float,
    exact,
    until: float,
    model: str,
    targets: tuple,
    more: tuple[Measure, ...] = (),
    ratios: tuple[float, ...] = (0.1, 1, 8),
) -> Case:
    times = np.arange(0.0, until + 1e-9, 0.02)
    return Case(
        id=case,
        title=title,
        scene=scene,
        about=about,
        source="diffusion equation with the body as its boundary, finite volumes",
        resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
        measures=(Measure(f"{label}, NRMSE", "%", lambda r: against(r, column, start, exact, until), targets), *more),
        methods=COUPLED,
        variants=tuple(
            Variant(f"r{r:g}", {f"models.{model}.density": f"{1000 * r:g}"}, {"ratio": r}) for r in ratios
        ),
        chart=Chart(
            "t (s)",
            label,
            lambda r: (r.series(column)[0], r.values(column) / start),
            lambda v, f: (times, exact(v.values["ratio"], times)),
        ),
    )


SPIN_DOWN = fading(
    "B5",
    "Spin-down in an annulus: torque",
    "spin_down",
    "A cylinder turns at 1 rad/s in a fluid at rest in a fixed concentric cylinder twice as wide, viscosity 1e-3 m^2/s, "
    "at density ratios 0.1, 1 and 8. Angular momentum: that of fluid and cylinder, and what the wall was given, over that at the start.",
    "body.wy",
    "speed of turning / at the start",
    1.0,
    annulus_spin_down,
    5,
    "body",
    (0.04, 0.02, 0.01),
    (Measure("angular momentum lost in 5 s", "", turning_lost, (1e-6,)),),
)
PLATE = fading(
    "B6",
    "Free plate between walls: shear",
    "report/free_plate",
    "A plate 0.02 m thick slides between two walls, 0.1 m from each, viscosity 1e-3 m^2/s, at density ratios 0.1, 1 and 10.",
    "plate.vx",
    "speed / at the start",
    0.1,
    plate_between_walls,
    4,
    "plate",
    (0.03, 0.015, 0.007),
    ratios=(0.1, 1, 10),
)

# B8

EDGE, RADIUS, MU, DRAG = 0.2688, 0.05, 10.0, 2.008  # m, m, Pa s, K of Zick and Homsy at a volume fraction of 0.027


BOX, BALL = EDGE**3, 4 / 3 * math.pi * RADIUS**3  # m^3
WEIGHT = 1000 * BALL * 0.18  # N, of the sphere less its buoyancy
# In the frame that falls with the centre of mass the fluid has an opposite uniform force, so that the total is zero:
# F of Zick and Homsy = rho_f a V for an acceleration a = weight less buoyancy / all mass.
SETTLED = 1000 * WEIGHT / (1000 * (BOX - BALL) + 2000 * BALL) * BOX / (6 * math.pi * MU * RADIUS * DRAG)  # m/s


def settling(run: Outcome) -> float:
    """Speed of the sphere relative to the mean of the box at the end, over the exact one."""
    ledger = run.record["ledger"]
    fluid = ledger["momentum_end"][2] / ledger["mass_kg"]
    return (1 - BALL / BOX) * (fluid - run.values("body.vz")[-1]) / SETTLED


def settling_speed(run: Outcome) -> tuple[Array, Array]:
    """The same in time, m/s: what momentum the weight has given and the sphere has not got is the fluid's."""
    t, v = run.series("body.vz")
    fluid = (-WEIGHT * t - 2000 * BALL * v) / run.record["ledger"]["mass_kg"]
    return t, (1 - BALL / BOX) * (fluid - v)


SPHERES = Case(
    id="B8",
    title="Periodic array of sinking spheres: drag",
    scene="report/periodic_sphere",
    about="A sphere in a periodic box 2.688 diameters wide, Reynolds number 0.05, after 1.5 s (six times the time that viscosity needs "
    "to cross a radius).",
    source="A.A. Zick and G.M. Homsy, J. Fluid Mech. 115 (1982) 13-26: K = 2.008",
    resolutions=(("coarse", 0.0224), ("10s", 0.0168), ("1min", 0.0112), ("10min", 0.0064)),  # parts of the edge
    measures=(Measure("speed", "%", lambda r: abs(settling(r) - 1), (0.08, 0.04, 0.02)),),
    chart=Chart(
        "t (s)",
        "speed against the mean of the box (m/s)",
        settling_speed,
        lambda v, f: (np.array([0, 1.5]), np.array([SETTLED, SETTLED])),
        "Zick and Homsy",
    ),
)

CASES = (SPRING, SPRING_VISCOSITIES, SPIN_DOWN, PLATE, SPHERES)
