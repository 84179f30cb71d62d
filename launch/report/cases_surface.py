"""Fluid alone with a free surface and an exact answer: drops, a patch that turns, a U-shaped channel, a slot."""

import math

import numpy as np

from case import Case, Chart, Measure, Outcome
from metrics import NoFigure, extrema, nrmse, period, relative, settles_to, slope
from references import drop_axes, square_patch_pressure

Array = np.ndarray
G = 9.81  # m/s^2, as in the scenes

# F5: radius 1 m


def stretched(strain: float, attraction: float):
    """NRMSE of the semi-axis along z, which a probe sees as the level above the centre."""

    def error(run: Outcome) -> float:
        t, b = run.series("top")
        return nrmse(b, drop_axes(strain, attraction, t)[1])

    return error


def energy_lost(run: Outcome) -> float:
    """Per period, over the kinetic energy at the start."""
    start = 0.5 * 1000 * 0.5**2 * math.pi / 2
    return abs(run.record["ledger"]["energy_J"]["change"]) / start / 3


SWINGS = np.linspace(0, 13.71, 300)
DROP = Case(
    id="F5",
    title="Oscillating drop",
    scene="report/drop",
    about="A drop of 1 m radius under a force towards its centre, set going by a strain of 0.5 1/s, swings between ellipses; its height over "
    "three periods of 4.57 s. Energy: what is lost per period over the kinetic energy at the start. The implicit solver knows no such force.",
    source="ordinary differential equations of J.J. Monaghan and A. Rafiee, Int. J. Numer. Meth. Fluids 71 (2013) 537-561",
    resolutions=(("coarse", 0.1), ("10s", 0.05), ("1min", 0.025), ("10min", 0.0125)),
    measures=(
        Measure("height, NRMSE", "%", stretched(0.5, 1), (0.04, 0.02, 0.01)),
        Measure("energy lost per period", "%", energy_lost, (0.05, 0.02, 0.01)),
    ),
    methods=("wcsph",),
    chart=Chart(
        "t (s)", "half the height (m)", lambda r: r.series("top"), lambda v, f: (SWINGS, drop_axes(0.5, 1, SWINGS)[1])
    ),
)

STRETCH = np.linspace(0, 7.6e-3, 100)
STRETCHING = Case(
    id="F5f",
    title="Stretching drop",
    scene="report/drop",
    about="The drop without the force and with a strain of -100 1/s: in 7.6 ms it is nearly twice as high. Sound speed 1500 m/s.",
    source="ordinary differential equations of J.J. Monaghan, J. Comput. Phys. 110 (1994) 399-406",
    resolutions=(("coarse", 0.1), ("10s", 0.05), ("1min", 0.025)),
    measures=(Measure("height, NRMSE", "%", stretched(-100, 0), (0.04, 0.02, 0.01)),),
    overrides={
        "world.attraction.rate": "0",
        "fluids.drop.strain": "-100",
        "world.duration": "7.6e-3",
        "numerics.sound_speed": "1500",
        "output.every": "1e-4",
    },
    chart=Chart(
        "t (s)",
        "half the height (m)",
        lambda r: r.series("top"),
        lambda v, f: (STRETCH, drop_axes(-100, 0, STRETCH)[1]),
    ),
)

# F6

SUCTION = 1000 * square_patch_pressure()  # Pa, at 1 rad/s and 1 m


def patch_pressure(run: Outcome) -> float:
    """Mean from 0.06 to 0.2 s, one period of the sound that the sudden start makes (c = 10 m/s)."""
    return relative(run.mean("centre", 0.06, 0.2), SUCTION)


def spin_lost(run: Outcome) -> float:
    ledger = run.record["ledger"]
    return relative(ledger["angular_momentum_end_N_m_s"][1], ledger["angular_momentum_start_N_m_s"][1])


def largest_void(run: Outcome) -> float:
    """At any time, over the area of a particle: enclosed in the patch and further than a spacing from every particle."""
    return float(np.max(run.values("void"))) / run.h**2


PATCH = Case(
    id="F6",
    title="Rotating square patch",
    scene="report/square_patch",
    about="A square of fluid of 1 m turns in empty space at 1 rad/s, without friction, for 2 s. Its pressure at the start is a mean over one "
    "period of the sound in it; its angular momentum is constant; suction must not tear it. A void is enclosed in the patch, further than a spacing from every particle, and of more than a "
    "particle's area: less is open for a moment wherever particles are in disorder. Without particle shifting the explicit solver tears it, too (4.5 and 109 particles at 4 and 2 cm).",
    source="double series of lap p = 2 rho omega^2: -0.14734 rho omega^2 L^2 in the middle",
    resolutions=(("coarse", 0.08), ("10s", 0.04), ("1min", 0.02), ("10min", 0.01)),
    measures=(
        Measure("pressure in the middle at the start", "%", patch_pressure, (0.10, 0.05, 0.03)),
        Measure("angular momentum after 2 s", "", spin_lost, (1e-3, 1e-4, 1e-6)),
        Measure("largest void until 2 s / particle", "", largest_void, (1,)),
    ),
    chart=Chart(
        "t (s)",
        "pressure in the middle (Pa)",
        lambda r: r.series("centre", 0, 0.4),
        lambda v, f: (np.array([0, 0.2]), np.array([SUCTION, SUCTION])),
        "at the start",
    ),
)

# F7

COLUMN = 2 * 0.6925 + math.pi * 0.1 / math.log(0.25 / 0.15)  # m, with potential flow in the bend
SWING = 2 * math.pi * math.sqrt(COLUMN / (2 * G))


def difference(run: Outcome) -> tuple[Array, Array]:
    t, left = run.series("left")
    return t, left - run.values("right")


def swings(run: Outcome) -> Array:
    """The extremes after the difference has passed zero, m."""
    tops = extrema(*difference(run))[1]
    if tops.size < 7:
        raise NoFigure(f"the levels have only {tops.size} extremes")
    return tops


def levels_differ(run: Outcome) -> float:
    """Difference that the swing settles to, in spacings."""
    return abs(settles_to(swings(run))[0]) / run.h


def still_apart(run: Outcome) -> float:
    """Difference of the levels at the end, mean over the last half second, in spacings."""
    t, y = difference(run)
    return abs(float(y[t >= t[-1] - 0.5].mean())) / run.h


def height_lost(run: Outcome) -> float:
    """Over a period."""
    return 1 - settles_to(swings(run))[1] ** 2


VESSELS = Case(
    id="F7",
    title="Communicating vessels",
    scene="report/u_tube",
    about="Water without viscosity swings in a U of 0.1 m width; period of the difference of the levels over one and a half swings, and the "
    "difference that it settles to, which is zero.",
    source="T = 2 pi sqrt(Le / 2 g), Le = 2.000 m with potential flow in the bend, to about 0.3 %",
    resolutions=(("coarse", 0.025), ("10s", 0.02), ("1min", 0.01), ("10min", 0.005)),
    measures=(
        Measure("period", "%", lambda r: relative(period(*difference(r), count=3), SWING), (0.04, 0.02, 0.01)),
        Measure("levels at rest differ by", "dx", levels_differ, (0.5, 0.3, 0.2)),
        Measure("height lost per period", "%", height_lost),
        Measure("levels at the end differ by", "dx", still_apart),
    ),
    chart=Chart(
        "t (s)",
        "difference of the levels (m)",
        difference,
        lambda v, f: ((t := np.linspace(0, 4.5, 200)), 0.2 * np.cos(2 * math.pi * t / SWING)),
        "without loss",
    ),
)

# F8

SLOT, CONTRACTION = 0.1, math.pi / (math.pi + 2)
STEADY = 0.4, 0.8  # s


def tank_level(run: Outcome) -> tuple[Array, Array]:
    t, left = run.series("level_left", *STEADY)
    return t, (left + run.values("level_right", *STEADY)) / 2


def discharge(run: Outcome) -> float:
    """Rate at which the level of the tank, 1 m wide, falls over sqrt(2 g h) times the slot, against free-streamline theory."""
    t, level = tank_level(run)
    return relative(-slope(t, level) / (math.sqrt(2 * G * float(level.mean())) * SLOT), CONTRACTION)


def jet_speed(run: Outcome) -> float:
    """A slot's width below the floor: Bernoulli between there and the surface, which falls itself."""
    _, level = tank_level(run)
    exact = np.sqrt(2 * G * (level + SLOT) / (1 - (CONTRACTION * SLOT) ** 2))
    return relative(-run.mean("jet.vz", *STEADY), float(exact.mean()))


TORRICELLI = Case(
    id="F8",
    title="Outflow through a slot",
    scene="report/slot",
    about="A tank of 1 x 1 m empties through a slot of 0.1 m with sharp edges in its floor; speed of the jet a slot's width below, against Bernoulli from the falling surface down to there, and discharge, from "
    "0.4 to 0.8 s. Particles that have left are lost on purpose.",
    source="Torricelli; contraction pi / (pi + 2) of free-streamline theory",
    resolutions=(("coarse", 0.025), ("coarse", 0.0166667), ("10s", 0.01), ("1min", 0.006), ("10min", 0.004)),
    measures=(
        Measure("speed of the jet", "%", jet_speed, (0.05, 0.03, 0.02)),
        Measure("discharge", "%", discharge, (0.10, 0.05, 0.03)),
    ),
    chart=Chart(
        "t (s)",
        "level in the tank (m)",
        lambda r: (r.series("level_left")[0], (r.values("level_left") + r.values("level_right")) / 2),
        lambda v, f: (
            (t := np.linspace(0, 0.8, 50)),
            (1 - CONTRACTION * SLOT * math.sqrt(G / 2) * t) ** 2,
        ),
        "Torricelli, from t = 0 on",
    ),
)

CASES = (DROP, STRETCHING, PATCH, VESSELS, TORRICELLI)
