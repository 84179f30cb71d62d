"""Cases with a published experiment, whose tables may not be carried along: they are read from --references."""

import numpy as np

from case import LOST, Case, Chart, Measure, Outcome, Variant, judged_at
from metrics import IMPACT_S, NoFigure, first_row, nrmse, relative, resample, rms, running_mean
from references import read_table

G = 9.81  # m/s^2, as in the scenes
LIFT = 1.0  # s of the run before the gate is lifted, where the experiment's clock starts


def track(table: str, column: str, folders: list) -> tuple[np.ndarray, np.ndarray]:
    rows = read_table(table, folders)
    return rows["t_s"], rows[column]


def deviation(run: Outcome, of: str, table: str, column: str, until: float) -> float:
    """rms on the reference's own sample times up to `until`, m."""
    t, y = track(table, column, run.references)
    t, y = t[t <= until], y[t <= until]
    simulated = run.series(of)
    return rms(resample(simulated[0] - LIFT, simulated[1], t) - y)


def ahead(run: Outcome) -> float:
    """By how much the top cube is ahead of the measured one, mean over the last half second, m; negative: behind."""
    t, x = track(THREE.format("x"), "x_m", run.references)
    late = (t >= 1.2) & (t <= 1.7)
    simulated = run.series("top.x")
    return float(np.mean(resample(simulated[0] - LIFT, simulated[1], t[late]) - x[late]))


ABOUT = (
    "Flume 8 x 0.7 x 0.7 m (7 m here: the reservoir is 2.5 instead of 3.5 m long, whose back wall is felt after 2.8 s only), water 0.4 m deep behind a gate that is lifted at "
    "1.9 m/s after 1 s in which nothing may move; cubes of 0.15 m and 800 kg/m^3, near face 1.7 m downstream, restitution 0.1. When the water comes is not in the data. Friction is not in the data: 0.3 is judged, 0.15 and 0.45 show what it does. "
    "The flume is open on top: particles lost are spray that leapt over its walls."
)
SOURCE = "R.B. Canelas et al., Comput. Phys. Commun. 202 (2016) 131-140, digitised; nothing below 0.01 m is meaningful"
LEVELS = (("coarse", 0.05), ("10s", 0.0375), ("1min", 0.03), ("10min", 0.02))
ONE = "dambreak_one_cube_canelas_2016_exp_x.csv"
COLUMN = ("low", "middle", "top")  # its cubes
THREE = "dambreak_three_stacked_cubes_canelas_2016_exp_{}.csv"


def tracked(column: str, name: str, table: str, measured: str) -> Chart:
    return Chart(
        "t from the lift of the gate (s)",
        name,
        lambda r: (r.series(column)[0] - LIFT, r.values(column)),
        lambda v, f: track(table, measured, f),
        "Canelas et al. 2016",
        points=True,
    )


def still(column: str, start: float):
    return lambda run: float(np.max(np.abs(run.values(column, 0, LIFT) - start)))


def friction(mu: float, cubes: tuple[str, ...]) -> dict[str, str]:
    """The same of the cubes and the flume."""
    return {f"models.{m}.friction": f"{mu:g}" for m in (*cubes, "flume")}


def rubbing(cubes: tuple[str, ...]) -> tuple[Variant, ...]:
    """Friction of the cubes and the flume. The one that is judged comes first."""
    return tuple(
        Variant(
            f"mu{mu:g}",
            friction(mu, cubes),
            {"friction": mu},
            without=() if mu == 0.3 else (0.0375,),
        )
        for mu in (0.3, 0.15, 0.45)
    )


def water_comes(run: Outcome) -> float:
    """When water first stands on the bed 5 cm before the cubes, s after the lift of the gate."""
    t, level = run.series("water", LIFT)
    return float(t[first_row(level > 0, "no water comes to the cubes")]) - LIFT


def first_at(t: np.ndarray, x: np.ndarray, place: float) -> float:
    """When x first reaches a place, linear between rows."""
    i = first_row(x >= place, f"x does not come to {place:g} m")
    if i == 0:
        raise NoFigure(f"x starts beyond {place:g} m")
    return float(t[i - 1] + (place - x[i - 1]) * (t[i] - t[i - 1]) / (x[i] - x[i - 1]))


def leaves(run: Outcome) -> float:
    """When the cube has moved by 5 cm, which digitised places, scattered by 2 cm, tell; difference to the experiment, s."""
    t, x = run.series("cube.x")
    return abs(first_at(t - LIFT, x, 1.825) - first_at(*track(ONE, "x_m", run.references), 1.825))


def falls(run: Outcome) -> float:
    """When the top cube's centre sinks below 0.225 m, against 1.10 s in the experiment."""
    t, z = run.series("top.z", LIFT)
    return relative(float(t[first_row(z < 0.225, "the top cube does not fall")]) - LIFT, 1.10)


ONE_CUBE = Case(
    id="X1a",
    title="Dam break on one cube",
    scene="one_cube",
    about=ABOUT,
    source=SOURCE,
    resolutions=LEVELS,
    measures=(
        Measure("track x, rms", "m", lambda r: deviation(r, "cube.x", ONE, "x_m", 1.55), judged_at((0.10, 0.06, 0.04), friction=0.3)),
        Measure("way before the gate is lifted", "m", still("cube.x", 1.775), (1e-3,)),
        Measure("time at which it has moved by 5 cm", "s", leaves),
        Measure("water at the cube, after the lift", "s", water_comes),
        LOST,
    ),
    variants=rubbing(("cube",)),
    shown=(0,),
    chart=tracked("cube.x", "x of the cube (m)", ONE, "x_m"),
)

THREE_CUBES = Case(
    id="X1b",
    title="Dam break on a column of three cubes",
    scene="three_cubes",
    about=ABOUT,
    source=SOURCE,
    resolutions=LEVELS,
    measures=(
        Measure(
            "track x of the top cube, rms",
            "m",
            lambda r: deviation(r, "top.x", THREE.format("x"), "x_m", 1.7),
            judged_at((0.06, 0.03, 0.015), friction=0.3),
        ),
        Measure(
            "track z of the top cube, rms",
            "m",
            lambda r: deviation(r, "top.z", THREE.format("z"), "z_m", 1.7),
            judged_at((0.06, 0.035, 0.022), friction=0.3),
        ),
        Measure("top cube below 0.225 m", "%", falls),
        Measure("way before the gate is lifted", "m", still("top.x", 1.775), (1e-3,)),
        Measure("water at the cubes, after the lift", "s", water_comes),
        LOST,
        Measure("top cube ahead of the measured one from 1.2 s on", "m", ahead),
    ),
    variants=rubbing(COLUMN),
    shown=(0,),
    chart=tracked("top.x", "x of the top cube (m)", THREE.format("x"), "x_m"),
    second_chart=tracked("top.z", "z of the top cube (m)", THREE.format("z"), "z_m"),
)


# X2b

LOBOVSKY = "dambreak_pressure_lobovsky_2014_p{}.csv"
BUCHNER = "dambreak_pressure_buchner_2002.csv"
HEIGHT = 0.3  # m, of the column


def wall_pressure(run: Outcome, sensor: str = "p1") -> tuple[np.ndarray, np.ndarray]:
    """t sqrt(g / H) and p / (rho g H)."""
    t, p = run.series(sensor)
    return t * np.sqrt(G / HEIGHT), p / (1000 * G * HEIGHT)


def pressure_table(table: str, folders: list) -> tuple[np.ndarray, np.ndarray]:
    rows = read_table(table, folders)
    return rows["t_star"], rows["p_star"]


def arrival(run: Outcome) -> float:
    t, p = wall_pressure(run)
    return relative(float(t[first_row(p > 0.1, "no pressure at the wall")]), 2.43)


def mean_until_six(t: np.ndarray, p: np.ndarray) -> float:
    """Mean over time from t* = 3 to 6, which a single impact does not decide; the rows of a table are not evenly spaced."""
    at = np.linspace(3, 6, 3001)
    return float(np.trapz(resample(t, p, at), at)) / 3


def mean_pressure(sensor: str, table: str):
    def error(run: Outcome) -> float:
        measured = mean_until_six(*pressure_table(table, run.references))
        return relative(mean_until_six(*wall_pressure(run, sensor)), measured)

    return error


def largest_pressure(run: Outcome) -> float:
    """A mean over 1 ms."""
    p = running_mean(*run.series("p1"), IMPACT_S) / (1000 * G * HEIGHT)
    return relative(float(p.max()), float(pressure_table(LOBOVSKY.format(1), run.references)[1].max()))


IMPACT = Case(
    id="X2b",
    title="Dam break: pressure on the far wall",
    scene="report/dam_break_wall",
    about="A column of 0.6 x 0.3 m collapses in a tank of 1.61 m; when the wall is hit, and the mean pressure 3 mm above its foot (P1) "
    "from t sqrt(g / H) = 3 to 6. Two-dimensional; a probe is as wide as the kernel, more than a sensor, and the largest pressure a mean over 1 ms. "
    "P3 and P4 are 30 and 80 mm above the bed; Buchner's sensor, in a tank twice as large, is shown without a target.",
    source="L. Lobovsky et al., J. Fluids Struct. 48 (2014) 407-434: arrival at t sqrt(g / H) = 2.43; B. Buchner, PhD thesis, TU Delft (2002); tables digitised",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005)),
    measures=(
        Measure("arrival", "%", arrival, (0.05, 0.03, 0.02)),
        Measure("mean pressure P1, t* 3 to 6", "%", mean_pressure("p1", LOBOVSKY.format(1)), (0.20, 0.15, 0.10)),
        Measure("the same, P3", "%", mean_pressure("p3", LOBOVSKY.format(3)), (0.20, 0.15, 0.10)),
        Measure("the same, P4", "%", mean_pressure("p4", LOBOVSKY.format(4)), (0.20, 0.15, 0.10)),
        Measure("the same, at Buchner's sensor", "%", mean_pressure("buchner", BUCHNER)),
        Measure("largest pressure P1", "%", largest_pressure),
    ),
    chart=Chart(
        "t sqrt(g / H)",
        "p / (rho g H)",
        wall_pressure,
        lambda v, f: pressure_table(LOBOVSKY.format(1), f),
        "Lobovsky et al. 2014",
        points=True,
    ),
)

# X3f

FREE_BOX = Case(
    id="X3f",
    title="Dam break on a box that is free",
    scene="report/obstacle_free",
    about="The dam break on an obstacle, with a box that may slide: 2000 kg/m^3, friction 0.3, the whole tank. How far the wave has pushed it "
    "1.5 s after the start, shown without a target: there is no measurement, it tells when something changes.",
    source="none",
    resolutions=(("coarse", 0.05), ("10s", 0.04), ("1min", 0.028)),
    measures=(Measure("way at 1.5 s", "m", lambda r: float(np.ptp(r.values("box.x")[[0, -1]]))), LOST),
    chart=Chart("t (s)", "x of the box (m)", lambda r: r.series("box.x")),
)

# X9b

SHALLOW = "sloshing_bouscasse_2013_series5.csv"
PERIOD = 1 / 0.33343  # s, of the tank
EARLIER = 6  # periods that the run is shorter than the experiment: the wave repeats itself


def shallow_wave(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Time of the experiment over the period, and height at the gauge over that at rest."""
    t, z = run.series("gauge", 2 * PERIOD)
    return t / PERIOD + EARLIER, z - 0.03


def shallow_table(folders: list) -> tuple[np.ndarray, np.ndarray]:
    rows = read_table(SHALLOW, folders)
    return rows["t"], rows["eta"]


def shallow_error(run: Outcome) -> float:
    t, eta = shallow_table(run.references)
    return nrmse(resample(*shallow_wave(run), t), eta)


SHALLOW_SWAY = Case(
    id="X9b",
    title="Sloshing of shallow water",
    scene="report/sloshing_shallow",
    about="Water 30 mm deep in a tank of 1 m that moves by 70 mm with a period of 3.0 s: a bore runs to and fro. Height 0.05 m from a wall; the experiment's "
    "periods 8.5 to 11 are compared with the run's 2.5 to 5. Shown without a target: the table is for regression only.",
    source="B. Bouscasse et al., Int. J. Nonlinear Sci. Numer. Simul. 14 (2013) 123-138, fig. 19, digitised",
    resolutions=(("10s", 0.01), ("1min", 0.005)),
    measures=(
        Measure("elevation, NRMSE", "%", shallow_error),
        Measure(
            "highest crest",
            "%",
            lambda r: relative(float(shallow_wave(r)[1].max()), float(shallow_table(r.references)[1].max())),
        ),
    ),
    chart=Chart(
        "t / period", "elevation (m)", shallow_wave, lambda v, f: shallow_table(f), "Bouscasse et al. 2013", points=True
    ),
)

CASES = (IMPACT, ONE_CUBE, THREE_CUBES, FREE_BOX, SHALLOW_SWAY)
