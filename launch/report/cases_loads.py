"""Experiments with loads: pressure on an obstacle, force on a pillar, waves in a tank that is moved. Tables from --references."""

import math

import numpy as np

from case import LOST, Case, Chart, Measure, Outcome
from metrics import IMPACT_S, best_shift, first_row, nrmse, relative, resample, running_mean
from references import read_table

Array = np.ndarray
G = 9.81  # m/s^2, as in the scenes

# X3

COLUMN = 0.55  # m, height of the water
CALM_S = 0.02  # s, over which the pressure of single particles evens out
OBSTACLE = "dambreak_obstacle_kleefsman_2005_p{}.csv"


def sensor(number: int, mean_over: float = IMPACT_S):
    def curve(run: Outcome) -> tuple[Array, Array]:
        """t sqrt(g / H) and p / (rho g H), a running mean."""
        t, p = run.series(f"p{number}")
        return t * math.sqrt(G / COLUMN), running_mean(t, p, mean_over) / (1000 * G * COLUMN)

    return curve


def measured(number: int, folders: list, until: float = 6.3) -> tuple[Array, Array]:
    table = read_table(OBSTACLE.format(number), folders)
    at = table["t_star"] <= until
    return table["t_star"][at], table["p_star"][at]


def rise(t: Array, p: Array) -> float:
    """When p first passes 0.2."""
    return float(t[first_row(p > 0.2, "no pressure at the sensor")])


def pressure_error(number: int):
    def error(run: Outcome) -> float:
        t, p = measured(number, run.references)
        return nrmse(resample(*sensor(number)(run), t), p)

    return error


def calm_error(number: int):
    """What is left without single particles, and with the experiment's clock: NRMSE of means over 20 ms after the best shift
    of at most 0.1 in t*."""

    def error(run: Outcome) -> float:
        return best_shift(*sensor(number, CALM_S)(run), *measured(number, run.references), 0.1)[1]

    return error


def peak_error(mean_over: float = IMPACT_S):
    return lambda run: relative(float(sensor(1, mean_over)(run)[1].max()), float(measured(1, run.references)[1].max()))


OBSTACLE_HIT = Case(
    id="X3",
    title="Dam break on an obstacle",
    scene="report/obstacle",
    about="A column of 1.228 x 1 x 0.55 m collapses in a tank of 3.22 m on a box of 0.161 m; pressure on its near face 0.021 m (P1) and 0.101 m (P3) above "
    "the bed. Half of the tank. A probe is as wide as the kernel, more than a sensor, and pressure a mean over 1 ms. The tank is open on top: particles lost are spray "
    "that leapt over its walls (at 2.8 cm 0.2 and 0.1 % of all, with a lid none).",
    source="K.M.T. Kleefsman et al., J. Comput. Phys. 206 (2005) 363-393, digitised; P1 rises at t sqrt(g / H) = 1.67",
    resolutions=(("coarse", 0.05), ("10s", 0.04), ("1min", 0.028), ("10min", 0.02)),
    measures=(
        Measure(
            "P1, first rise",
            "%",
            lambda r: relative(rise(*sensor(1)(r)), rise(*measured(1, r.references))),
            (0.06, 0.03, 0.02),
        ),
        Measure(
            "P1, peak",
            "%",
            peak_error(),
            (0.5, 0.3, 0.2),
        ),
        Measure("P1, NRMSE", "%", pressure_error(1), (0.25, 0.18, 0.12)),
        Measure("P3, NRMSE", "%", pressure_error(3), (0.25, 0.18, 0.12)),
        Measure("P1, NRMSE of means over 20 ms after a shift", "%", calm_error(1)),
        Measure("P3, the same", "%", calm_error(3)),
        Measure("P1, largest mean over 20 ms", "%", peak_error(CALM_S)),
        LOST,
    ),
    chart=Chart(
        "t sqrt(g / H)", "P1 / (rho g H)", sensor(1), lambda v, f: measured(1, f), "Kleefsman et al. 2005", points=True
    ),
)

# X8

FORCE = "dambreak_pillar_yeh_petroff_force.csv"


def force_measured(folders: list) -> tuple[Array, Array]:
    table = read_table(FORCE, folders)
    at = (table["t_s"] >= 0) & (table["t_s"] <= 1.45)
    return table["t_s"][at], table["F_N"][at]


def force_on_pillar(run: Outcome) -> tuple[Array, Array]:
    """A mean over 1 ms."""
    t, force = run.series("pillar.fx")
    return t, running_mean(t, force, IMPACT_S)


def force_error(run: Outcome) -> float:
    t, force = force_measured(run.references)
    return nrmse(resample(*force_on_pillar(run), t), force)


def force_shifted(run: Outcome) -> tuple[float, float]:
    return best_shift(*force_on_pillar(run), *force_measured(run.references), 0.1)


def calm_force(run: Outcome) -> float:
    """Its largest mean over 0.05 s against that of the experiment."""
    largest = [float(running_mean(t, f, 0.05).max()) for t, f in (run.series("pillar.fx"), force_measured(run.references))]
    return relative(*largest)


VELOCITY = "dambreak_pillar_yeh_petroff_velocity.csv"


def bore(run: Outcome) -> tuple[Array, Array]:
    """Speed of the water 0.146 m before the pillar. The table's time counts from when the bore comes there, at which it has
    its largest speed (2.1 m/s at 9 ms): so does this one, from when half of that is first passed."""
    t, v = run.series("bore.vx")
    return t - t[first_row(v > 1.05, "no bore comes to the place")], v


def velocity_error(run: Outcome) -> float:
    table = read_table(VELOCITY, run.references)
    return nrmse(resample(*bore(run), table["t_s"]), table["v_m_per_s"])


PILLAR = Case(
    id="X8",
    title="Bore on a pillar",
    scene="report/pillar",
    about="A column of 0.4 x 0.61 x 0.3 m collapses in a tank of 1.6 m and hits a square pillar of 0.12 m; streamwise force up to 1.45 s, and speed of the water 0.146 m before it, "
    "2.6 cm above the bed, from when the bore comes there. A layer of 1 cm "
    "lies on the bed, one row of particles of less than their volume at all but the finest level. Force is a mean over 1 ms. "
    "The tank is open on top: particles lost are spray that leapt over its walls (explicit, at 2 cm: 0.2 to 0.3 %).",
    source="H. Yeh and C. Petroff, as plotted by P.E. Raad and R. Bidoae, J. Comput. Phys. 203 (2005) 668-699, digitised",
    resolutions=(("coarse", 0.04), ("10s", 0.03), ("1min", 0.02), ("10min", 0.012)),
    measures=(
        Measure(
            "largest force",
            "%",
            lambda r: relative(float(force_on_pillar(r)[1].max()), float(force_measured(r.references)[1].max())),
            (0.4, 0.25, 0.15),
        ),
        Measure("force, NRMSE", "%", force_error, (0.25, 0.18, 0.12)),
        Measure("speed of the water, NRMSE", "%", velocity_error, (0.25, 0.18, 0.12)),
        Measure("force, NRMSE after a shift", "%", lambda r: force_shifted(r)[1]),
        Measure("that shift, the run later", "s", lambda r: -force_shifted(r)[0]),
        Measure("largest force, mean over 0.05 s", "%", calm_force),
        LOST,
    ),
    chart=Chart("t (s)", "force (N)", force_on_pillar, lambda v, f: force_measured(f), "Yeh and Petroff", points=True),
)

# X9

SLOSHING = "sloshing_faltinsen_2000_hw06_T13.csv"


def elevation(run: Outcome) -> tuple[Array, Array]:
    t, z = run.series("gauge")
    return t, z - 0.6


def gauge(folders: list) -> tuple[Array, Array]:
    table = read_table(SLOSHING, folders)
    return table["t_s"], table["eta_m"]


def elevation_error(run: Outcome) -> float:
    t, eta = gauge(run.references)
    return nrmse(resample(*elevation(run), t), eta)


SWAY = Case(
    id="X9",
    title="Sloshing",
    scene="report/sloshing",
    about="A tank of 1.73 m with water 0.6 m deep is moved by 32 mm with a period of 1.3 s, near its own 1.6 s, for 10 s; height of the water at a gauge 0.05 m "
    "from a wall that moves along. The tank starts at rest, at the end of its way.",
    source="O.M. Faltinsen et al., J. Fluid Mech. 407 (2000) 201-234, fig. 7, digitised",
    resolutions=(("coarse", 0.04), ("10s", 0.03), ("1min", 0.02), ("10min", 0.0125)),
    measures=(Measure("elevation, NRMSE", "%", elevation_error, (0.2, 0.12, 0.08)),),
    chart=Chart("t (s)", "elevation (m)", elevation, lambda v, f: gauge(f), "Faltinsen et al. 2000", points=True),
)

CASES = (OBSTACLE_HIT, PILLAR, SWAY)
