"""Bodies alone that turn at 10,000 rad/s."""

import numpy as np

from case import Case, Measure, Outcome, Variant
from cases_rigid import STEP, box_inertia, energy_drift
from metrics import NoFigure

STATE = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")
FAST_SPIN = np.array([6000.0, 8000, 0])  # rad/s
SOLIDS = {  # 12 kg: their shape, and their moments of inertia
    "box": ("{ box: [0.3, 0.6, 0.9] }", box_inertia(12, (0.3, 0.6, 0.9))),
    "sphere": ("{ sphere: { radius: 0.3 } }", np.full(3, 0.4 * 12 * 0.3**2)),
}


def sphere_turned(run: Outcome) -> float:
    """Largest angle between the sphere's orientation and the exact one, rad."""
    if not run["sphere"]:
        raise NoFigure("by its formula for a sphere only")
    w, *v = (run.values(f"body.q{c}") for c in "wxyz")
    v, half = np.stack(v, axis=1), np.linalg.norm(FAST_SPIN) / 2 * run.series("body.qw")[0][:, None]
    axis = FAST_SPIN / np.linalg.norm(FAST_SPIN)
    off = np.cos(half) * v - w[:, None] * np.sin(half) * axis - np.cross(np.sin(half) * axis, v)
    return 2 * float(np.arcsin(np.minimum(np.linalg.norm(off, axis=1), 1)).max())


def spinning(case: str, about: str, resolutions: tuple, measures: tuple[Measure, ...], **more) -> Case:
    return Case(
        id=case,
        scene="report/free_flight",
        about=about,
        knob=STEP,
        resolutions=resolutions,
        methods=("ode", "free_body"),
        variants=tuple(
            Variant(name, {"models.body.shape": shape}, {"sphere": name == "sphere"})
            for name, (shape, _) in SOLIDS.items()
        ),
        overrides={
            "world.duration": "1",
            "output.every": "0.0001",
            "models.body.velocity": "[0, 0, 0]",
            "models.body.angular_velocity": "[6000, 8000, 0]",
        },
        measures=measures,
        **more,
    )


def fast_drift(run: Outcome) -> float:
    return energy_drift(run, SOLIDS["sphere" if run["sphere"] else "box"][1])


def not_numbers(run: Outcome) -> int:
    return sum(int((~np.isfinite(run.values(f"body.{c}"))).sum()) for c in STATE)


FAST = spinning(
    "R15",
    "A box with edges as 1 to 2 to 3 and a sphere at 10,000 rad/s, the box about an axis between its principal ones, for 1 s: a hundredth of a radian a step. "
    "The orientation has no target.",
    (("coarse", 1e-5), ("10s", 1e-6)),
    (
        Measure("energy drift", "", fast_drift, (1e-6,)),
        Measure("orientation of the sphere", "rad", sphere_turned),
    ),
    title="Fast spin",
    source="conservation of energy; the sphere turns about an axis that stays, w t",
)
FAST_IN_LONG_STEPS = spinning(
    "R15n",
    "The same with steps of 1 ms, ten radians each: every number stays a number.",
    (("10s", 1e-3),),
    (
        Measure("values that are NaN or infinite", "", not_numbers, (0,)),
        Measure("energy drift", "", fast_drift),
        Measure("orientation of the sphere", "rad", sphere_turned),
    ),
    title="Fast spin in long steps",
    source="none: values must stay finite",
)

CASES = (FAST, FAST_IN_LONG_STEPS)
