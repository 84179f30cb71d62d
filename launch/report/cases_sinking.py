"""Bodies that sink and rise in experiments."""

from collections.abc import Callable

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import NoFigure, relative, resample, rms
from references import TEN_CATE, read_table

Array = np.ndarray

# X6


def fastest(run: Outcome) -> float:
    return float(np.max(-run.values("ball.vz")))


def largest_speed(run: Outcome) -> float:
    return fastest(run) / run["u_inf"]


SETTLING = Case(
    id="X6",
    title="Settling sphere",
    scene="report/settling_sphere",
    about="A sphere of 15 mm and 1120 kg/m^3 settles in silicone oil in a box of 100 x 100 x 160 mm, full to the top; its largest speed over that in an endless "
    "fluid, Reynolds numbers 1.5 to 31.9. Reduced gravity; the gap to the floor, which is not resolved, is not looked at. "
    "Sound at 4 m/s: the excess weight (rho_b - rho) g d, not the speed, sets how much is compressed: 0.15 % (at 2 m/s, 0.6 %, the fastest falls 8 to 26 % too fast).",
    source="A. ten Cate et al., Phys. Fluids 14 (2002) 4012-4025, tables I and II",
    resolutions=(("10s", 0.005), ("1min", 0.00375), ("10min", 0.0025)),
    measures=(
        Measure(
            "largest speed / in an endless fluid",
            "%",
            lambda r: relative(largest_speed(r), r["measured"]),
            (0.12, 0.06, 0.04),
        ),
    ),
    variants=tuple(
        Variant(
            name,
            {
                "fluids.oil.density": f"{rho}",
                "fluids.oil.viscosity": f"{mu}",
                "world.duration": f"{duration}",
            },
            {"u_inf": u, "measured": ratio},
        )
        for (name, (rho, mu, u, ratio)), duration in zip(TEN_CATE.items(), (0.8, 0.8, 0.7, 0.9))
    ),
    chart=Chart(
        "t (s)",
        "speed (m/s)",
        lambda r: (r.series("ball.vz")[0], -r.values("ball.vz")),
        lambda v, f: (np.array([0, 0.9]), np.full(2, v.values["measured"] * v.values["u_inf"])),
        "largest speed measured",
    ),
)

# Re 31.9 of it both ways. The pressure of the weight, 1500 Pa at the floor, needs ten times sqrt(g H) for a speed of sound.
REDUCED = Variant("reduced", {"world.duration": "0.6"})
FULL = Variant("full", {"world.duration": "0.6", "numerics.reduced_gravity": "false", "numerics.sound_speed": "12.5"})


def both_ways(speed: Callable[[Outcome], float]) -> Callable[[Outcome], float]:
    def difference(run: Outcome) -> float:
        if run.variant.name == REDUCED.name:
            raise NoFigure("what the other is compared with")
        return relative(speed(run), speed(run.beside(REDUCED)))

    return difference


WEIGHING = Case(
    id="X6g",
    title="Settling sphere, gravity both ways",
    scene="report/settling_sphere",
    about="The fastest of these spheres for 0.6 s with reduced gravity, as above, and with that of the fluid in full; their largest speeds should "
    "agree within 2 %. At one resolution.",
    source="the run with reduced gravity",
    resolutions=(("10s", 0.006),),
    measures=(
        Measure("largest speed, full against reduced gravity", "%", both_ways(fastest), lambda v: (0.02,) if v is FULL else ()),
        Measure("largest speed", "m/s", fastest),
        Measure("mean speed from 0.3 s on, full against reduced", "%", both_ways(lambda r: r.mean("ball.vz", 0.3))),
    ),
    beside=lambda job: (REDUCED, job.h),
    variants=(REDUCED, FULL),
    chart=Chart("t (s)", "speed (m/s)", lambda r: (r.series("ball.vz")[0], -r.values("ball.vz"))),
)

# X7


def height(folders: list, table: str) -> tuple[Array, Array]:
    rows = read_table(table, folders)
    at = rows["t_s"] >= 0
    return rows["t_s"][at], rows["z_m"][at]


def block(case: str, title: str, scene: str, about: str, table: str, size: float, until: float) -> Case:
    def error(run: Outcome) -> float:
        t, z = height(run.references, table)
        at = t <= until
        return rms(resample(*run.series("block.z"), t[at]) - z[at]) / size

    return Case(
        id=case,
        title=title,
        scene=scene,
        about=about + " Two-dimensional, as the third dimension is not in the data: shown without a target.",
        source="Wu et al. 2014, set-up of L.-C. Qiu et al., Math. Probl. Eng. 2017, 3174904, digitised",
        resolutions=(("coarse", 0.005), ("10s", 0.004), ("1min", 0.002), ("10min", 0.001)),
        measures=(Measure("height / size of the block, rms", "", error),),
        chart=Chart(
            "t (s)",
            "height of the centre (m)",
            lambda r: r.series("block.z"),
            lambda v, f: height(f, table),
            "Wu et al. 2014",
            points=True,
        ),
    )


SINKING = block(
    "X7a",
    "Sinking block",
    "report/sinking_block",
    "A block of 20 mm and 2120 kg/m^3 sinks from the surface of water 131 mm deep.",
    "falling_block_wu_2014_exp_z.csv",
    0.020,
    0.4,
)
RISING = block(
    "X7b",
    "Rising block",
    "report/rising_block",
    "A block of 49 x 24 mm and 800.5 kg/m^3 rises from the floor in water 52 mm deep.",
    "rising_block_wu_2014_exp_z.csv",
    0.024,
    1.49,
)

CASES = (SETTLING, WEIGHING, SINKING, RISING)
