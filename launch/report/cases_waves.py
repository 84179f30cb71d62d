"""Bodies that pressure drives: sound in a column, waves on a surface, water behind a gate, impact on water."""

import math
from collections.abc import Callable

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant, judged_at
from metrics import NoFigure, decay_rate, period, relative, resample, rms
from references import hinge_moment, piston_root, read_table, slamming

Array = np.ndarray
G = 9.81  # m/s^2, as in the scenes

# B7

MASSES = (0.01, 0.1, 1, 10, 100)  # of the piston to the fluid


def piston_frequency(run: Outcome) -> float:
    """Over two periods about the place where the column carries the 20 N: F L / (rho c^2 A) = 1 mm lower."""
    t, z = run.series("piston.z")
    return 1 / period(t, z - z[0] + 1e-3, count=4)


def piston_decay(run: Outcome) -> float:
    """Share of the amplitude that is lost in a period, from the first four extremes; the artificial viscosity is 0.005."""
    t, z = run.series("piston.z")
    return 1 - math.exp(-decay_rate(t, z - z[0] + 1e-3, count=4) / piston_frequency(run))


def exact_frequency(run: Outcome) -> float:
    return 10 * piston_root(run["ratio"]) / (2 * math.pi)


def lowest(t: Array, z: Array, at: float, within: float) -> float:
    """When z is lowest near a time: the vertex of a parabola through the rows."""
    near = np.abs(t - at) <= within
    if np.count_nonzero(near) < 3:
        raise NoFigure(f"fewer than three rows lie around {at:g} s")
    square, line, _ = np.polyfit(t[near] - at, z[near], 2)
    return at - float(line / (2 * square))


def frequency_by_troughs(run: Outcome) -> float:
    """Between the first two times at which the piston is lowest, wherever the middle of its swing is."""
    t, z = run.series("piston.z")
    cycle = 1 / exact_frequency(run)
    first, second = (lowest(t, z, (k + 0.5) * cycle, cycle / 8) for k in range(2))
    return 1 / (second - first)


def piston(mass: float, speed: float = 0) -> Variant:
    """speed: of the piston at the start, into the fluid, m/s."""
    overrides = {"models.piston.mass": f"{200 * mass:g}"} | ({"world.duration": "15"} if mass > 10 else {})
    if speed:
        overrides["models.piston.velocity"] = f"[0, 0, {-speed:g}]"
    return Variant(f"m{mass:g}" + ("-pushed" if speed else ""), overrides, {"ratio": mass})


PISTON = Case(
    id="B7",
    title="Piston on a compressible column",
    scene="report/piston",
    about="A piston on a column of 1 m, sound speed 10 m/s, closed at the other end, let go under a pressure of a thousandth of rho c^2, at "
    "ratios of piston to fluid mass of 0.01 to 100, from rest and (0.01, 0.1) with a thousandth of c in addition. First frequency over two periods. The implicit solver has no sound and is left out.",
    source="linear acoustics: q tan q = fluid mass / piston mass",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005)),
    measures=(
        Measure(
            "frequency",
            "%",
            lambda r: relative(piston_frequency(r), exact_frequency(r)),
            (0.02, 0.01, 0.003),
        ),
        Measure("swing lost in a period", "%", piston_decay),
        Measure("frequency, from trough to trough", "%", lambda r: relative(frequency_by_troughs(r), exact_frequency(r))),
    ),
    methods=("wcsph", "staggered"),
    variants=(*(piston(m) for m in MASSES), *(piston(m, 0.01) for m in (0.01, 0.1))),
    shown=tuple(range(len(MASSES))),
    chart=Chart(
        "mass of the piston / of the fluid",
        "frequency (Hz)",
        lambda r: (r["ratio"], piston_frequency(r)),
        lambda v, f: ((m := np.geomspace(0.01, 100, 80)), np.array([10 * piston_root(x) / (2 * math.pi) for x in m])),
        joined=True,
        log_x=True,
    ),
)

# B9

HEAVE = "heave_decay_halfimmersed_cylinder_theory.csv"
RADIUS, DEPTH = 0.0762, 0.5  # m


def immersed(height: float) -> float:
    """Area of a circle below a line `height` under its centre, m^2."""
    return RADIUS**2 * math.acos(height / RADIUS) - height * math.sqrt(RADIUS**2 - height**2)


def rest(lift: float, tank: float) -> float:
    """Height of the centre at rest in a tank of that width, m: where it starts lifted less water is carved out."""
    return DEPTH + (math.pi * RADIUS**2 / 2 - immersed(lift)) / tank


def heave(run: Outcome, spread: float = 1) -> tuple[Array, Array]:
    """t sqrt(g / a) and height over that at the start, about where it would rest once a share of the water that it pushes
    aside has spread over the tank."""
    t, z = run.series("body.z")
    middle = DEPTH + spread * (rest(run["lift"], run["tank"]) - DEPTH)
    return t * math.sqrt(G / RADIUS), (z - middle) / (z[0] - middle)


def heave_error(run: Outcome, spread: float = 1) -> float:
    table = read_table(HEAVE, run.references)
    at = table["t_star"] <= 9
    return rms(resample(*heave(run, spread), table["t_star"][at]) - table["y_over_y0"][at])


def heave_error_at_best(run: Outcome) -> float:
    """In the sea of the theory nothing is left of that water; in the tank it spreads while the cylinder swings."""
    return min(heave_error(run, spread) for spread in np.linspace(0, 1, 21))


def heave_theory(folders: list) -> tuple[Array, Array]:
    table = read_table(HEAVE, folders)
    return table["t_star"][:91], table["y_over_y0"][:91]


def heaving(
    case: str, title: str, lifted: str, lift: float, resolutions: tuple
) -> Case:
    return Case(
        id=case,
        title=title,
        scene="report/heave_decay",
        about=f"A cylinder of 0.1524 m and half the water's density is lifted by {lifted} and let go. Linear theory of deep water; "
        "waves come back from the walls after t sqrt(g / a) = 9.",
        source="F. Ursell's multipoles and Cummins' equation, evaluated for this project",
        resolutions=resolutions,
        measures=(
            Measure("height, rms over that at the start", "", heave_error, (0.08, 0.04, 0.02)),
            Measure("about the level that fits best, rms", "", heave_error_at_best),
        ),
        variants=(Variant("", {"models.body.pose": f"[1, 0, {DEPTH + lift:g}]"}, {"lift": lift, "tank": 2}),),
        chart=Chart("t sqrt(g / a)", "height / at the start", heave, lambda v, f: heave_theory(f), "linear theory"),
    )


HEAVING = heaving(
    "B9",
    "Heave decay of a half-immersed cylinder",
    "a third of its radius",
    0.0254,
    (("coarse", 0.01905), ("10s", 0.0127), ("1min", 0.0076), ("10min", 0.0038)),
)
HEAVING_LITTLE = heaving(
    "B9s",
    "Small heave of a half-immersed cylinder",
    "5 mm, a fifteenth of its radius",
    0.005,
    (("coarse", 0.0127), ("10s", 0.0076), ("1min", 0.0047625)),
)

# B13


def moment(run: Outcome) -> Array:
    """About the hinge, at x = 0.65 m on the bed, N m per metre; the probe's torque is about the centre of mass."""
    fx, fz, torque = (run.values(f"gate.{f}", 1) for f in ("fx", "fz", "ty"))
    return run.values("gate.z", 1) * fx - (run.values("gate.x", 1) - 0.65) * fz + torque


EXACT = hinge_moment(0.5)
THRUST = 1000 * G * 0.5**2 / 2  # N per metre, on the gate


def on_foot(run: Outcome) -> float:
    """Horizontal force on the round foot, in its groove, over that on the gate: it goes through the hinge."""
    return run.mean("gate.fx", 1) / THRUST - 1
GATE = Case(
    id="B13",
    title="Gate that holds back water",
    scene="report/gate",
    about="A gate locked at a hinge on the bed holds back water 0.5 m deep; its moment about the hinge from 1 s on, and how much it shakes. Its foot is round, about the hinge, in a groove of "
    "the bed: the pressure of what water is beside it, between gate and bed, goes through the hinge.",
    source="hydrostatics: rho g H^3 / 6, 204.4 N m / m",
    resolutions=(("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125), ("10min", 0.00625)),
    measures=(
        Measure("mean moment", "%", lambda r: relative(float(moment(r).mean()), EXACT), (0.03, 0.015, 0.007)),
        Measure("rms of the moment", "%", lambda r: float(moment(r).std()) / EXACT, (0.05, 0.02, 0.01)),
        Measure("force on the foot / on the gate", "%", on_foot),
    ),
    chart=Chart(
        "t (s)",
        "moment about the hinge (N m / m)",
        lambda r: (r.series("gate.fx", 1)[0], moment(r)),
        lambda v, f: (np.array([1, 4]), np.array([EXACT, EXACT])),
        "rho g H^3 / 6",
    ),
)

SWINGING = 140.0, 140 * (0.1**2 + 0.7**2) / 12  # kg and kg m^2 about its centre, of the gate per metre


def gate_energy(run: Outcome) -> tuple[Array, Array]:
    """Kinetic and potential energy of the gate, and what the water has given it, J per metre."""
    mass, inertia = SWINGING
    t, vx = run.series("gate.vx")
    vz, spin = run.values("gate.vz"), run.values("gate.wy")
    power = sum(run.values(f"gate.{f}")[1:] * (v[1:] + v[:-1]) / 2 for f, v in (("fx", vx), ("fz", vz), ("ty", spin)))
    work = np.concatenate([[0], np.cumsum(power * np.diff(t))])  # there is a row for every step
    return mass * ((vx**2 + vz**2) / 2 + G * run.values("gate.z")) + inertia * spin**2 / 2, work


def energy_gained(run: Outcome) -> float:
    """The most that the water and the gate had gained at any time, with what they gave each other, over the energy at play."""
    energy, work = gate_energy(run)
    at_play = run.record["ledger"]["energy_J"]["reference"]
    return run.record["error"]["energy_gain"] + max(0.0, float((energy - energy[0] - work).max())) / at_play


def fallen(run: Outcome) -> tuple[Array, Array]:
    return run.series("gate.qy")[0], np.degrees(2 * np.arctan2(run.values("gate.qy"), run.values("gate.qw")))


def before_release(run: Outcome) -> float:
    t, angle = fallen(run)
    return float(np.max(np.abs(angle[t <= 1])))


RELEASED = Case(
    id="B13r",
    title="Gate let go",
    scene="report/gate_released",
    about="A gate as wide and high with a flat foot, on a hinge at the foot of its dry side, leans on a latch that is drawn away after 1 s: it falls over and the water runs out. Energy of water and "
    "gate never rises above the start; 1 % of the energy at play is allowed, as in the stability suite.",
    source="conservation of energy",
    resolutions=(("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125)),
    measures=(
        Measure("energy gained / at play", "%", energy_gained, (0.01,)),
        Measure("way before it is let go", "deg", before_release, (0.1,)),
    ),
    chart=Chart("t (s)", "angle of the gate (deg)", fallen),
)

# B12

# By the angle between face and water, degrees: F / (rho V^3 t), and the largest pressure on the face over rho V^2 / 2.
WEDGES = {25: (23.657, 10.691), 30: (14.139, 6.927), 40: (5.477, 3.266)}
ADDED = 0.1**2 / 2 * 1000  # kg per metre and coefficient of the force: the force is the added mass's growth times the speed, way 0.1 m
FACE = range(70, 131, 10)  # mm, heights over the edge of the probes on one face, that move with it


def wedge(variant: Variant) -> tuple[float, float]:
    return WEDGES[int(variant.values["angle"])]


def on_face(height: float, angle: float) -> str:
    """A place on the face of the wedge, mm over its edge, in the wedge's frame."""
    return f"[{height / 1000 / math.tan(math.radians(angle)):.6g}, 0, {height / 1000}]"


def wedge_force(run: Outcome) -> float:
    """F / (rho V^3 t): the line through the origin that fits best, without the first quarter."""
    t, force = run.series("wedge.fz", 0.005)
    return float((force * t).sum() / np.square(t).sum()) / (1000 * 5**3)


def face_pressure(run: Outcome) -> float:
    """Largest on the face over rho V^2 / 2. It depends on height / V t alone: a mean over probes and rows of the last half in
    each tenth of that, as single rows show the particles that hit."""
    at, p = [], []
    for height in FACE:
        t, values = run.series(f"p{height}", 0.01)
        at.append(height / 1000 / (5 * t))
        p.append(values / (500 * 5**2))
    place, pressure = np.floor(10 * np.concatenate(at)), np.concatenate(p)
    return max(float(pressure[place == k].mean()) for k in np.unique(place) if np.count_nonzero(place == k) >= 5)


WEDGE = Case(
    id="B12",
    title="Wedge that enters water",
    scene="report/wedge_entry",
    about="A free wedge goes into water at 5 m/s at 25, 30 and 40 degrees between face and water, without gravity; it weighs 10,000 times its added mass at the end and keeps its speed "
    "to 1e-4. The force grows with time. Pressure on the face, by probes that move as the wedge, is a mean over places at the same height / V t, in tenths; a probe is as wide as the kernel.",
    source="R. Zhao and O. Faltinsen, J. Fluid Mech. 246 (1993) 593-612, table 1",
    resolutions=(("coarse", 0.02), ("10s", 0.01), ("1min", 0.005)),
    measures=(
        Measure("force / time", "%", lambda r: relative(wedge_force(r), wedge(r.variant)[0]), (0.15, 0.08, 0.05)),
        Measure("largest pressure", "%", lambda r: relative(face_pressure(r), wedge(r.variant)[1]), (0.3, 0.2, 0.12)),
    ),
    variants=tuple(
        Variant(
            f"{a}deg",
            {
                "models.wedge.shape.mesh.scale": f"[1, 1, {math.tan(math.radians(a)):.10g}]",
                "models.wedge.mass": f"{1e4 * ADDED * WEDGES[a][0]:.6g}",
            }
            | {f"probes.p{z}.pressure_at": on_face(z, a) for z in FACE},
            {"angle": a},
        )
        for a in WEDGES
    ),
    chart=Chart(
        "t (s)",
        "F / (rho V^3) (s)",
        lambda r: (r.series("wedge.fz")[0], r.values("wedge.fz") / (1000 * 5**3)),
        lambda v, f: ((t := np.linspace(0, 0.02, 20)), wedge(v)[0] * t),
        "similarity solution",
    ),
)

# X4

ENTRY = "cylinder_entry_rho{}_{}.csv"


def penetration(run: Outcome) -> tuple[Array, Array]:
    t, z = run.series("body.z")
    return t * math.sqrt(G / 0.11), (z[0] - z) / 0.11


def entry_reference(density: float, of: str, folders: list) -> tuple[Array, Array]:
    table = read_table(ENTRY.format(f"{density:g}", of), folders)
    after = table["t_star"] >= 0
    return table["t_star"][after], table["penetration"][after]


def entry_error(run: Outcome) -> float:
    at, exact = entry_reference(run["density"], "bem", run.references)
    return rms(resample(*penetration(run), at) - exact)


def entry_error_above(run: Outcome) -> float:
    """Until two diameters deep: the tank is 2.7 of them deep, and the gap to its floor is not resolved at the end."""
    at, exact = entry_reference(run["density"], "bem", run.references)
    at, exact = at[exact <= 2], exact[exact <= 2]
    return rms(resample(*penetration(run), at) - exact)


def entry_error_measured(run: Outcome) -> float:
    if run["density"] != 500:
        raise NoFigure("the digitised experiment of this density is not used: it is faster than at the impact")
    at, measured = entry_reference(500, "greenhow_lin_1983_exp", run.references)
    return rms(resample(*penetration(run), at) - measured)


def slamming_error(run: Outcome) -> float:
    """Of the force over rho D V^2 / 2, V its speed then, as a mean over the way from the surface to half a diameter deep."""
    deep = penetration(run)[1]
    coefficient = run.values("body.fz") / (500 * 0.11 * run.values("body.vz") ** 2)
    at = np.linspace(0, 0.5, 501)
    return relative(float(resample(deep, coefficient, at).mean()), float(slamming(at).mean()))


def by_density(light: tuple[float, ...], heavy: tuple[float, ...]) -> Callable[[Variant], tuple[float, ...]]:
    """Targets of densities 500 and 1000."""
    return lambda variant: light if variant.values["density"] == 500 else heavy


ENTERING = Case(
    id="X4",
    title="Cylinder that falls into water",
    scene="report/cylinder_entry",
    about="A cylinder of 0.11 m hits water 0.3 m deep at 2.955 m/s, density 500 and 1000 kg/m^3; how deep its centre is against a "
    "boundary-element solution and, at density 500, the experiment.",
    source="P.N. Sun et al., Appl. Ocean Res. 72 (2018) 60-75 (their boundary-element curve, digitised); experiment of M. Greenhow and W.-M. Lin, MIT report 83-19 (1983); slamming force: I.M.C. Campbell and P.A. Weynberg (1980)",
    resolutions=(("coarse", 0.011), ("10s", 0.0055), ("1min", 0.0022)),
    measures=(
        Measure(
            "way of the centre / D, rms",
            "",
            entry_error,
            by_density((0.08, 0.04, 0.025), (0.12, 0.07, 0.05)),
        ),
        Measure("the same against the experiment", "", entry_error_measured, judged_at((0.10, 0.06, 0.05), density=500)),
        Measure("way until 2 D deep, rms", "", entry_error_above),
        Measure("mean slamming coefficient, 0 to D / 2 deep", "%", slamming_error),
    ),
    variants=tuple(Variant(f"rho{d}", {"models.body.density": f"{d}"}, {"density": d}) for d in (500, 1000)),
    chart=Chart(
        "t sqrt(g / D)",
        "way of the centre / D",
        penetration,
        lambda v, f: entry_reference(v.values["density"], "bem", f),
        "boundary elements",
        points=True,
    ),
)

CASES = (PISTON, HEAVING, HEAVING_LITTLE, WEDGE, GATE, RELEASED, ENTERING)
