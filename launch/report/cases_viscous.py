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
    why="at 1 cm the frequency of light cylinders is 3.5 to 5.5 % too high (explicit), as the layer that viscosity drags along is as thin as half a spacing and most of its added mass is missing (by the order, below); 1.2 % at 5 mm. Implicit 1.6 to 9.7 % and 0.2 to 3.0 %: there another 0.14 and 0.05 of the displaced mass is missing at 1 cm and 5 mm. The decay: the swing, 4 mm, is 0.4 to 0.8 spacings, and shears the particles next to the cylinder into disorder, which takes energy: at 4 mm the first half swings are right (they reach 0.857 and 0.711 of the start, exact 0.871 and 0.759), the last lose a quarter each; a tenth of the density diffusion lowers the error from 50 to 30 %; with ten times the viscosity (B3n) the decay is right within 5 % at 5 mm (ratios 1 to 8), with a tenth it is 1.7 times too fast at 2.5 mm by either solver, 1.9 to 2.6 times at 4 mm (implicit), the frequency within 0.4 %. Implicit without particle shifting: light cylinders shook (300 %)",
    order_why="the frequency's is 1.7 to 2.4 from 1 cm to 5 mm, and below 1 from 2 to 1 cm for many ratios. Viscosity drags along a layer of 5.6 mm; frequency and decay give its share of the added mass, 0.24 of the displaced mass, as 0.04 at 1 cm and 0.18 at 5 mm (explicit, the same at every ratio), and by chance as -0.2 to 0.12 at 2 cm, where the swing is a fifth of a spacing; implicit -0.24 to -0.43, -0.1 and 0.13. The decay's error is of disorder, as above, not of the spacing: 1 to 18 % at 1 cm and 41 to 44 % at 5 mm (explicit), 69 to 109 and 55 to 91 % (implicit)",
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
    why="",
    order_why="the frequency's is 0.5 to 0.9 at 1e-5 m^2/s, explicit, with errors of 1.6 % and less: the layer that viscosity drags along, 1.8 mm, is thinner than either spacing, and of its added mass, 0.073 of the displaced mass, 0.02 comes out at 1 cm and 0.04 at 5 mm. The decay's there as in B3, of disorder",
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
    order_why: str,
    why: str = "",
    more: tuple[Measure, ...] = (),
    ratios: tuple[float, ...] = (0.1, 1, 8),
) -> Case:
    times = np.arange(0.0, until + 1e-9, 0.02)
    return Case(
        id=case,
        title=title,
        scene=scene,
        about=about,
        why=why,
        order_why=order_why,
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
    "implicit, heavy cylinder, 2 to 1 cm: 4.2 and 2.9 %, then 1.1 % at 5 mm; shorter steps and no shifting leave it (3.4, 3.8 % at 1 cm), so it is of the noise in the torque of a coarse ring. From 1 cm to 5 mm 0.83 (explicit, heavy: 0.87, 0.49 %) and 0.65 (implicit, ratio 1: 0.88, 0.56 %): explicit it is the length of the steps, with a Courant number of 0.1 0.11 %; implicit not (accurate: 0.54 %), but the disorder of the particles, which slows the cylinder too fast: 0.87 % without shifting; 0.33 % at 2.5 mm",
    "angular momentum: two particles push each other along the difference of their velocities (viscosity), not along the line that joins them, and shifting beside walls keeps no angular momentum. "
    "At 1 cm without shifting 1e-3 of it is lost at the density of the fluid (explicit), without viscosity either 7e-7 (explicit) and 2e-8 (implicit) in a fluid that turns",
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
    "from 2 to 1 cm, where the plate is one and two spacings thick; shorter steps change nothing; from 1 cm to 5 mm the order is 2 to 4",
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
    why="explicit, it sinks too fast: density diffusion evens out the pressure before and behind the sphere, which bears a third of the drag; with a fifth of it 2.7 instead of 5.1 % at 16.8 mm. Implicit, without any, 1.8, 1.6 and 0.6 % at 16.8, 11.2 and 6.4 mm",
    order_why="these spacings are too coarse for an order: the kernel's radius, 2.9 spacings, is about the sphere's (2.2 to 4.5); with the shorter cubic spline 3.6 instead of 5.1 % at 16.8 mm (explicit). Shorter steps change nothing. Implicit 1.6, 1.8, 1.6, 0.6 % at 22.4 to 6.4 mm",
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
