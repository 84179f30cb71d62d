"""Cases of bodies alone: the same engine adapter and the same command, without a fluid process."""

import math

import numpy as np

from case import Case, Chart, Measure, Outcome, Variant
from metrics import extrema, period, relative
from references import pendulum_period

G = 9.81  # m/s^2, as in the scenes
STEPS = (("coarse", 4e-3), ("coarse", 2e-3), ("10s", 1e-3), ("1min", 5e-4))
ROD = (1.5, 0.02)  # m, length and thickness


def rod_pose(degrees: float) -> str:
    """Pose of the rod that hangs on (0, 0, 2) at an angle from the vertical."""
    angle = math.radians(degrees)
    x, z = ROD[0] / 2 * math.sin(angle), 2 - ROD[0] / 2 * math.cos(angle)
    return f"[{x:.15g}, 0, {z:.15g}, 0, {math.pi / 2 - angle:.15g}, 0]"


def exact_period(run: Outcome) -> float:
    length, thick = ROD
    moment = (length**2 + thick**2) / 12 + length**2 / 4  # about the hinge, over the mass
    return pendulum_period(2 * math.pi * math.sqrt(moment / (G * length / 2)), math.radians(run["angle"]))


def swings(run: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Angle from the vertical, rad."""
    t, x = run.series("rod.x")
    return t, np.unwrap(np.arctan2(x, 2 - run.values("rod.z")))


def amplitude_loss(run: Outcome) -> float:
    """Per period: from the first to the last extreme of the angle, over the periods between them."""
    _, top = extrema(*swings(run))
    return abs(abs(top[-1]) - abs(top[0])) / abs(top[0]) / ((top.size - 1) / 2)


def hinge_gap(run: Outcome) -> float:
    """Largest deviation of the distance from hinge to centre, over the rod's length."""
    distance = np.hypot(run.values("rod.x"), run.values("rod.z") - 2)
    return float(np.max(np.abs(distance - ROD[0] / 2))) / ROD[0]


PENDULUM = Case(
    id="R4", title="Pendulum", scene="report/pendulum",
    about="A rod of 1.5 m on a hinge, let go at 5 to 150 degrees, for 12 s.",
    source="complete elliptic integral",
    knob="coupling.rigid_step", resolutions=STEPS, methods=("ode",),
    variants=tuple(Variant(f"{a}deg", {"models.rod.pose": rod_pose(a)}, {"angle": a}) for a in (5, 30, 60, 90, 120, 150)),
    measures=(
        Measure("period", "%", lambda r: relative(period(*swings(r)), exact_period(r)), (1e-3,)),
        Measure("amplitude lost per period", "%", amplitude_loss, (1e-3,)),
        Measure("gap of the hinge / length", "", hinge_gap, (1e-4,)),
    ),
    chart=Chart("angle (deg)", "period (s)", lambda r: (r["angle"], period(*swings(r))),
                lambda v, f: (np.arange(1, 160.0), np.array([
                    pendulum_period(2 * math.pi * math.sqrt(((ROD[0]**2 + ROD[1]**2) / 12 + ROD[0]**2 / 4) / (G * ROD[0] / 2)),
                                    math.radians(a)) for a in range(1, 160)])), joined=True),
)

CASES = (PENDULUM,)
