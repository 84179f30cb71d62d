"""Experiments with loads: pressure on an obstacle, force on a pillar, waves in a tank that is moved. Tables from --references."""

import math

import numpy as np

from case import LOST, Case, Chart, Measure, Outcome
from metrics import IMPACT_S, first_row, nrmse, relative, resample, running_mean
from references import read_table

Array = np.ndarray
G = 9.81  # m/s^2, as in the scenes

# X3

COLUMN = 0.55  # m, height of the water
OBSTACLE = "dambreak_obstacle_kleefsman_2005_p{}.csv"


def sensor(number: int):
    def curve(run: Outcome) -> tuple[Array, Array]:
        """t sqrt(g / H) and p / (rho g H), a mean over 1 ms."""
        t, p = run.series(f"p{number}")
        return t * math.sqrt(G / COLUMN), running_mean(t, p, IMPACT_S) / (1000 * G * COLUMN)

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


OBSTACLE_HIT = Case(
    id="X3",
    title="Dam break on an obstacle",
    order_why="the arrival tends to 2.7 % after the time measured, not to it, as above: 5 % at 5 and 4 cm, 2 to 3 % at 2.8 cm",
    why="without friction and gate the wave comes 2.7 % late however fine: t* = 1.716 and 1.719 in 2-D at 1 cm and 5 mm (1.73, 1.76 at 2 and 4 cm; 1.67 measured). Four of the table's twenty rows lie in the 0.01 s before the water comes in the run; they alone make an "
    "NRMSE of 30 %. With its time shifted by 0.06 in t* the implicit run at 2.8 cm is 17 % off. The peak is of a front thinner than a spacing, whose particles hit one by one: in 2-D 6 to 7 rho g H at 1 cm, 2.9 to 5.2 at 5 mm (2.0 measured); means over 10 ms 2.8 and 2.4",
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
            lambda r: relative(float(sensor(1)(r)[1].max()), float(measured(1, r.references)[1].max())),
            (0.5, 0.3, 0.2),
        ),
        Measure("P1, NRMSE", "%", pressure_error(1), (0.25, 0.18, 0.12)),
        Measure("P3, NRMSE", "%", pressure_error(3), (0.25, 0.18, 0.12)),
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
    why="the bore comes to the pillar at 0.29 s at 2 and 1.25 cm, at 0.25 and 0.30 s at 3 cm (0.35 measured; 0.26 over a dry bed): nothing holds it back, neither a gate nor friction. With the run shifted by 0.07 s, which is not allowed here, the force at 2 cm is within 15 % (explicit) and 11 % (implicit). "
    "Peaks over 1 ms are those of single particles; means over 0.05 s are 28 to 37 N (33 measured; 25 to 28 over a dry bed)",
    order_why="the largest force is one row in which particles hit, as above: there is nothing for it to converge to",
    title="Bore on a pillar",
    scene="report/pillar",
    about="A column of 0.4 x 0.61 x 0.3 m collapses in a tank of 1.6 m and hits a square pillar of 0.12 m; streamwise force up to 1.45 s, and speed of the water 0.146 m before it, "
    "2.6 cm above the bed, from when the bore comes there. A layer of 1 cm "
    "lies on the bed, one row of particles of less than their volume at all but the finest level. Force is a mean over 1 ms. "
    "The tank is open on top: particles lost are spray that leapt over its walls (explicit, at 2 cm: 0.3 %).",
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
    order_why="10 to 11 % with both solvers at every spacing, so not of the spacing: crests are 0.15 to 0.21 m high where 0.11 to 0.14 were measured, troughs a quarter to a third deeper, from the first swing on; in time they are right (a shift of 0.02 s takes 0.5 of the 10.5 %). Whether the motion of the tank, which the table only names, is that of the experiment is not known",
    scene="report/sloshing",
    about="A tank of 1.73 m with water 0.6 m deep is moved by 32 mm with a period of 1.3 s, near its own 1.6 s, for 10 s; height of the water at a gauge 0.05 m "
    "from a wall that moves along. The tank starts at rest, at the end of its way.",
    source="O.M. Faltinsen et al., J. Fluid Mech. 407 (2000) 201-234, fig. 7, digitised",
    resolutions=(("coarse", 0.04), ("10s", 0.03), ("1min", 0.02), ("10min", 0.0125)),
    measures=(Measure("elevation, NRMSE", "%", elevation_error, (0.2, 0.12, 0.08)),),
    chart=Chart("t (s)", "elevation (m)", elevation, lambda v, f: gauge(f), "Faltinsen et al. 2000", points=True),
)

CASES = (OBSTACLE_HIT, PILLAR, SWAY)
