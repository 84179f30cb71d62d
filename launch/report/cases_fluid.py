"""Cases of fluid alone."""

import numpy as np

from case import Case, Chart, Measure, Outcome
from metrics import NoFigure, best_shift, relative
from references import martin_moyce

G = 9.81  # m/s^2, as in the scenes


def rms_speed(run: Outcome) -> float:
    """Of all the fluid at the end, over sqrt(g H) with H = 1 m."""
    ledger = run.record["ledger"]
    return float(np.sqrt(2 * ledger["energy_J"]["kinetic"] / ledger["mass_kg"] / G))


HYDROSTATIC = Case(
    id="F1", title="Still water in a tank", scene="hydrostatic",
    about="A tank of 1 x 1 m in 2-D, full of water at rest, for 5 s. Pressure is rho g (H - z), the walls carry the weight.",
    source="hydrostatics",
    resolutions=(("coarse", 0.1), ("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125), ("10min", 0.00625)),
    measures=(
        Measure("pressure, L2 over rho g H", "%", lambda r: r.mean("pressure_error", 1), (0.01, 0.005, 0.003)),
        Measure("level, mean from 1 s", "dx", lambda r: abs(r.mean("level", 1) - 1) / r.h, (0.3, 0.2, 0.1)),
        Measure("force on the tank against the weight", "%", lambda r: relative(r.mean("walls.fz", 1), -1000 * G), ()),
        Measure("rms speed at the end / sqrt(g H)", "", rms_speed, (1e-2, 3e-3, 1e-3)),
    ),
    chart=Chart("t (s)", "L2 error of pressure / rho g H", lambda r: r.series("pressure_error")),
)

FRONT_AT = np.array([1.1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4, 4.25, 4.5])  # over the column's width
WIDTH = 0.3  # m


def front(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """t* and z / a of the surge: when the water first stands at each of the probes."""
    arrivals = []
    for index in range(FRONT_AT.size):
        t, level = run.series(f"x{index}")
        wet = np.nonzero(level > 0)[0]  # the bed; where there is no water the probe says less
        if wet.size == 0:
            break
        arrivals.append(t[wet[0]])
    if len(arrivals) < 3:
        raise NoFigure("the front reached fewer than three probes")
    return np.array(arrivals) * np.sqrt(2 * G / WIDTH), FRONT_AT[: len(arrivals)]


def front_error(run: Outcome) -> float:
    """NRMSE with one shift of at most 0.1 in t*, on the rows of the table that the probes cover."""
    t, z = front(run)
    at, reference = martin_moyce()
    inside = (at > t[0] + 0.1) & (at < t[-1] - 0.1)
    if np.count_nonzero(~inside & (at > t[0] + 0.1)):
        raise NoFigure(f"the front was followed to t* = {t[-1]:.3g} only")
    return best_shift(t, z, at[inside], reference[inside], 0.1)[1]


DAM_BREAK = Case(
    id="X2", title="Dam break: the surge front", scene="report/dam_break_front",
    about="A column of water 0.3 m wide and 0.6 m high collapses in 2-D; where its front is, from the times at which 15 "
          "probes along the bed get wet. One time shift of at most 0.1 in t* is allowed.",
    source="J.C. Martin and W.J. Moyce, Phil. Trans. R. Soc. Lond. A 244 (1952) 312-324; in every inviscid code the "
           "front runs ahead of the experiment (bed friction, gate)",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
    measures=(Measure("front, NRMSE after the shift", "%", front_error, (0.05, 0.03, 0.02)),),
    chart=Chart("t sqrt(2 g / a)", "front / a", front, lambda v, f: martin_moyce(), "Martin and Moyce 1952", points=True),
)

CASES = (HYDROSTATIC, DAM_BREAK)
