"""A drop with bodies in it that nothing acts on from outside."""

import math

import numpy as np

from case import Case, Chart, Measure, Outcome
from cases_coupled import momentum_drift, never_hit

MASSES = {"box": 500 * 0.3**2, "log": 2000 * math.pi * 0.15**2}  # kg per metre
INERTIA = {"box": MASSES["box"] * 0.3**2 / 6, "log": MASSES["log"] * 0.15**2 / 2}  # kg m^2 per metre


def angular_momentum(run: Outcome) -> list[np.ndarray]:
    """About the origin, of the fluid and of each body, in time."""
    parts = [run.values("motion.ly")]
    for name, m in MASSES.items():
        x, z, vx, vz, spin = (run.values(f"{name}.{c}") for c in ("x", "z", "vx", "vz", "wy"))
        parts.append(m * (z * vx - x * vz) + INERTIA[name] * spin)
    return parts


def turned(run: Outcome) -> np.ndarray:
    """Change of the angular momentum of all together, over the sizes of its parts at the start."""
    parts = angular_momentum(run)
    total = sum(parts)
    return (total - total[0]) / sum(abs(part[0]) for part in parts)


DROP = Case(
    id="B11d",
    title="Free drop: angular momentum",
    scene="report/free_drop",
    about="A drop of 1 m radius turns at 0.5 rad/s in empty space, without gravity; in it a log of twice its density runs into a box of half of it. Angular and linear momentum "
    "of all together, at their largest change in 2 s.",
    source="conservation; single precision in the fluid",
    resolutions=(("coarse", 0.1), ("coarse", 0.05), ("10s", 0.025), ("1min", 0.0125)),
    measures=(
        Measure("drift of angular momentum", "", lambda r: float(np.abs(turned(r)).max()), (1e-5,)),
        Measure("drift of total momentum", "", momentum_drift, (1e-5,)),
        Measure("given against received", "", lambda r: r.record["ledger"]["imbalance_relative"], (1e-12,)),
        Measure("box never hit (0: it was)", "", lambda r: never_hit(r, "box", MASSES), (0,)),
    ),
    chart=Chart(
        "t (s)",
        "change of angular momentum / at the start",
        lambda r: (r.series("motion.ly")[0], turned(r)),
        lambda v, f: (np.array([0, 2]), np.array([0, 0])),
        "constant",
    ),
)

CASES = (DROP,)
