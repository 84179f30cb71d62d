"""Cases of fluid alone."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import NoFigure, best_shift, extrema, observed_order, period, relative, resample, rms
from references import channel_startup, martin_moyce, read_table, sloshing_period

G = 9.81  # m/s^2, as in the scenes


def largest_speed(run: Outcome) -> float:
    """Of any particle at the end, over sqrt(g H) with H = 1 m."""
    return float(run.values("motion.fastest")[-1]) / float(np.sqrt(G))


def rms_speed(run: Outcome) -> float:
    """Of all the fluid at the end, over sqrt(g H) with H = 1 m."""
    ledger = run.record["ledger"]
    return float(np.sqrt(2 * ledger["energy_J"]["kinetic"] / ledger["mass_kg"] / G))


HYDROSTATIC = Case(
    id="F1",
    title="Still water in a tank",
    scene="hydrostatic",
    about="A tank of 1 x 1 m in 2-D, full of water at rest, for 5 s. Pressure is rho g (H - z), the walls carry the weight.",
    source="hydrostatics",
    resolutions=(("coarse", 0.1), ("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125), ("10min", 0.00625)),
    methods=("wcsph", "implicit", "wide"),
    measures=(
        Measure("pressure, L2 over rho g H", "%", lambda r: r.mean("pressure_error", 1), (0.01, 0.005, 0.003)),
        Measure("level, mean from 1 s", "dx", lambda r: abs(r.mean("level", 1) - 1) / r.h, (0.3, 0.2, 0.1)),
        Measure("force on the tank against the weight", "%", lambda r: relative(r.mean("walls.fz", 1), -1000 * G), ()),
        Measure("largest speed at the end / sqrt(g H)", "", largest_speed, (1e-2, 3e-3, 1e-3)),
        Measure("rms speed at the end / sqrt(g H)", "", rms_speed),
    ),
    chart=Chart(
        "t (s)",
        "force of the walls on the water / its weight",
        lambda r: (r.series("walls.fz", 0.1)[0], -r.values("walls.fz", 0.1) / (1000 * G)),
        lambda v, f: (np.array([0.1, 5]), np.array([1, 1])),
        "hydrostatics",
    ),
)

FRONT_AT = np.array(
    [1.1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4, 4.25, 4.5, 4.75, 5]
)  # over the column's width
WIDTH = 0.3  # m
ANY_SHIFT = 0.5  # in t*, more than any run needs


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


def shifted(run: Outcome, at: np.ndarray, reference: np.ndarray, most: float = 0.1) -> tuple[float, float]:
    """The one shift in t*, and the NRMSE with it, on the rows of a table that the probes cover."""
    t, z = front(run)
    inside = (at > t[0] + 0.1) & (at < t[-1] - 0.1)
    if not inside.any():
        raise NoFigure(f"the front was followed to t* = {t[-1]:.3g} only")
    return best_shift(t, z, at[inside], reference[inside], most)


def front_error(run: Outcome) -> float:
    at, reference = martin_moyce()
    if front(run)[0][-1] - 0.1 <= at[-1]:
        raise NoFigure(f"the front was followed to t* = {front(run)[0][-1]:.3g} only")
    return shifted(run, at, reference)[1]


def front_against(table: str, of: str):
    """Of a digitised table of columns twice as high as wide."""

    def error(run: Outcome) -> float:
        rows = read_table(f"dambreak_front_{table}.csv", run.references)
        return shifted(run, rows["t_star"], rows[of])[1]

    return error


DAM_BREAK = Case(
    id="X2",
    title="Dam break: the surge front",
    scene="report/dam_break_front",
    about="A column of water 0.3 m wide and 0.6 m high collapses in 2-D; where its front is, from the times at which 17 "
    "probes along the bed get wet. One time shift of at most 0.1 in t* is allowed, and shown; "
    "each of the other tables, without a target, has its own.",
    source="J.C. Martin and W.J. Moyce, Phil. Trans. R. Soc. Lond. A 244 (1952) 312-324; in every inviscid code the "
    "front runs ahead of the experiment",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005), ("10min", 0.0025)),
    measures=(
        Measure("front, NRMSE after the shift", "%", front_error, (0.05, 0.03, 0.02)),
        Measure("shift of the run in t*", "", lambda r: -shifted(r, *martin_moyce())[0]),
        Measure("the same front, digitised (2.25 in)", "%", front_against("martin_moyce_1952_a225", "z_over_a")),
        Measure("a column of 1.125 in", "%", front_against("martin_moyce_1952_a1125", "z_over_a")),
        Measure("after any shift", "%", lambda r: shifted(r, *martin_moyce(), most=ANY_SHIFT)[1]),
        Measure("which is", "", lambda r: -shifted(r, *martin_moyce(), most=ANY_SHIFT)[0]),
        Measure("Koshizuka and Oka's column", "%", front_against("koshizuka_oka_1996", "z_over_L")),
    ),
    chart=Chart(
        "t sqrt(2 g / a)", "front / a", front, lambda v, f: martin_moyce(), "Martin and Moyce 1952", points=True
    ),
)

# F2

SPOTS = {f"p{i}{j}": (0.1 + 0.25 * i, 0.15 + 0.25 * j) for i in range(4) for j in range(4)}
RATE = 8 * np.pi**2 * 0.01  # 1/s, of the decay of speed


def particles_at(folder: Path, time: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Time, places and velocities of all particles in the ParaView file nearest to a time."""
    from vtkmodules.util.numpy_support import vtk_to_numpy  # half a second to load, for this case alone
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    index = next(folder.rglob("*.pvd"))
    files = [(float(of.get("timestep")), of.get("file")) for of in ElementTree.parse(index).iter("DataSet")]
    t, name = min(files, key=lambda one: abs(one[0] - time))
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(index.parent / name))
    reader.Update()
    points, velocities = reader.GetOutput().GetPoints().GetData(), reader.GetOutput().GetPointData().GetArray("velocity")
    return t, *(vtk_to_numpy(values).astype(float) for values in (points, velocities))


def vortex_error(run: Outcome) -> float:
    """Mean error of both components over all particles at t = 1 s, over the largest exact speed then."""
    t, x, v = particles_at(run.folder, 1.0)
    fade, kx, kz = np.exp(-RATE * t), 2 * np.pi * x[:, 0], 2 * np.pi * x[:, 2]
    off = [v[:, 0] + np.cos(kx) * np.sin(kz) * fade, v[:, 2] - np.sin(kx) * np.cos(kz) * fade]
    return float(np.mean(np.abs(off))) / fade


def speed_left(run: Outcome) -> float:
    """Deviation of the rms speed of all the fluid after 2 s from the exact one, over the exact one."""
    ledger = run.record["ledger"]
    exact = 0.5 * np.exp(-2 * RATE)
    return relative(np.sqrt(2 * ledger["energy_J"]["kinetic"] / ledger["mass_kg"]) / np.sqrt(2), exact)


def mean_speed(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """rms over the 16 places, over its exact value at the start."""
    t = run.series("p00.vx")[0]
    squares = sum(np.square(run.values(f"{n}.v{c}")) for n in SPOTS for c in "xz")
    start = sum(
        (np.cos(2 * np.pi * x) * np.sin(2 * np.pi * z)) ** 2 + (np.sin(2 * np.pi * x) * np.cos(2 * np.pi * z)) ** 2
        for x, z in SPOTS.values()
    )
    return t, np.sqrt(squares / start)


TAYLOR_GREEN = Case(
    id="F2",
    title="Taylor-Green vortices",
    scene="report/taylor_green",
    about="Four vortices in a periodic square of 1 m, 1 m/s, Reynolds number 100, from a square lattice, for 2 s.",
    source="speed fades with exp(-8 pi^2 nu t)",
    resolutions=(("coarse", 1 / 16), ("coarse", 1 / 32), ("10s", 1 / 64), ("1min", 1 / 128)),
    measures=(
        Measure("velocity at 1 s, L1", "%", vortex_error, (0.06, 0.03, 0.015)),
        Measure("rms speed after 2 s", "%", speed_left, (0.10, 0.04, 0.02)),
    ),
    chart=Chart(
        "t (s)",
        "rms speed / at the start",
        mean_speed,
        lambda v, f: ((t := np.linspace(0, 2, 100)), np.exp(-RATE * t)),
        "exp(-8 pi^2 nu t)",
    ),
)

# F3: gap, viscosity and force per mass are 1 in the scene

HEIGHTS = {"a": 0.1, "b": 0.25, "c": 0.5, "d": 0.75, "e": 0.9}  # of the probes
TIMES = np.array([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
PLATE_SPEED = 0.1  # m/s, of the upper plane in the Couette flow


def channel_exact(couette: float, z: float, times: np.ndarray) -> np.ndarray:
    return np.array([channel_startup(np.array([z]), t)[int(couette)][0] for t in times]) * (
        PLATE_SPEED if couette else 1
    )


def channel_error(run: Outcome) -> float:
    """rms over five heights and seven times, over the largest speed."""
    off = [
        resample(*run.series(f"{name}.vx"), TIMES) - channel_exact(run["couette"], z, TIMES)
        for name, z in HEIGHTS.items()
    ]
    return rms(np.concatenate(off)) / (PLATE_SPEED if run["couette"] else 1 / 8)


COARSE_CHANNEL = 0.0625  # m, spacing from which on orders are looked at


def order_lacking(run: Outcome) -> float:
    """By how much the observed order since the coarse spacing is below 1.5."""
    if run.h >= COARSE_CHANNEL:
        raise NoFigure("orders begin here")
    coarse = run.beside(h=COARSE_CHANNEL)
    order = observed_order(coarse.h, channel_error(coarse), run.h, channel_error(run))
    if order is None:
        raise NoFigure("an error is zero")
    return max(1.5 - order, 0.0)


FINE = np.linspace(0, 1, 101)
CHANNEL = Case(
    id="F3",
    title="Start-up of channel flow",
    scene="report/channel",
    about="A viscous fluid between two planes is set in motion by a body force (Poiseuille) or by the upper plane (Couette); speed at five "
    "heights and seven times. The walls are at their true place.",
    source="Fourier series of J.P. Morris, P.J. Fox, Y. Zhu, J. Comput. Phys. 136 (1997) 214-226",
    resolutions=(("coarse", 0.1), ("coarse", 0.0625), ("10s", 0.03125), ("1min", 0.015625)),
    measures=(
        Measure("speed, rms over the largest", "%", channel_error, (0.01, 0.003, 0.001)),
        Measure("order lacking since 1/16 (1.5 asked)", "", order_lacking, (0.0,)),
    ),
    beside=lambda job: (job.variant, COARSE_CHANNEL),
    variants=(
        Variant("poiseuille", {}, {"couette": 0}),
        Variant(
            "couette",
            {"world.gravity": "[0, 0, 0]", "models.ceiling.prescribed": f"{{ velocity: [{PLATE_SPEED}, 0, 0] }}"},
            {"couette": 1},
        ),
    ),
    chart=Chart(
        "t nu / L^2",
        "speed at z / L = 0.5 (m/s)",
        lambda r: (r.series("c.vx")[0], r.values("c.vx")),
        lambda v, f: (FINE, channel_exact(v.values["couette"], 0.5, FINE)),
        "Fourier series",
    ),
)

# F4

AMPLITUDE = 0.05  # m
WAVE = sloshing_period(2, 1, 2) * (1 + (np.pi * AMPLITUDE) ** 2 / 8)  # s, with the lengthening by a finite amplitude


def wave(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Height of the middle above still water, over the amplitude."""
    t, z = run.series("middle")
    return t, (z - 1) / AMPLITUDE


def amplitude_lost(run: Outcome) -> float:
    """Of the way from trough to crest: from the start, a trough, and the crest behind it to those five periods later.
    A crest is higher than a trough is deep, and the start is a cosine, which is not quite a wave: one alone would not do."""
    _, tops = extrema(*wave(run))
    if tops.size < 11:
        raise NoFigure(f"the wave has only {tops.size} extremes")
    return 1 - abs(float((tops[10] - tops[9]) / (tops[0] - wave(run)[1][0])))


STANDING_WAVE = Case(
    id="F4",
    title="Standing wave",
    scene="report/standing_wave",
    about="A standing wave of 2 m and an amplitude of 5 cm in a tank of 2 x 1 m without viscosity, five periods; and how much of its "
    "height from trough to crest is lost by then.",
    source="omega^2 = g k tanh(k H), period longer by (k A)^2 / 8",
    resolutions=(("coarse", 0.08), ("coarse", 0.04), ("10s", 0.02), ("1min", 0.0125), ("10min", 0.01)),
    methods=("wcsph", "implicit", "wide"),
    measures=(
        Measure("period", "%", lambda r: relative(period(*wave(r), count=8), WAVE), (0.02, 0.01, 0.005)),
        Measure("height lost", "%", amplitude_lost, (0.2, 0.1, 0.05)),
    ),
    chart=Chart(
        "t (s)",
        "height of the middle / amplitude",
        wave,
        lambda v, f: ((t := np.linspace(0, 6.6, 300)), -np.cos(2 * np.pi * t / WAVE)),
        "first order, lengthened",
    ),
)

CASES = (HYDROSTATIC, TAYLOR_GREEN, CHANNEL, STANDING_WAVE, DAM_BREAK)
