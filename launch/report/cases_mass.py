"""Mass and moments of inertia of shapes, as the engine has them: by the kinetic energy of a body that moves and turns."""

import math

import numpy as np

from case import Case, Measure, Outcome, Variant
from cases_rigid import STEP, box_inertia
from metrics import relative

Array = np.ndarray
SPIN = np.array([1.0, 2.0, 3.0])  # rad/s, so that no two axes can be taken for each other
SHAPE, MASS = "models.body.shape", "models.body.density"


def sphere(r: float) -> tuple[float, Array]:
    """Mass at unit density and principal moments."""
    mass = 4 / 3 * math.pi * r**3
    return mass, np.full(3, 0.4 * mass * r**2)


def cylinder(r: float, length: float) -> tuple[float, Array]:
    mass = math.pi * r**2 * length
    across = mass * (r**2 / 4 + length**2 / 12)
    return mass, np.array([across, across, mass * r**2 / 2])


def capsule(r: float, length: float) -> tuple[float, Array]:
    (middle, moments), (caps, ball) = cylinder(r, length), sphere(r)
    across = moments[0] + ball[0] + caps * (length**2 / 4 + 3 / 8 * length * r)
    return middle + caps, np.array([across, across, moments[2] + ball[2]])


def box(x: float, y: float, z: float) -> tuple[float, Array]:
    return x * y * z, box_inertia(x * y * z, (x, y, z))


def prism(edges: int, r: float, length: float) -> tuple[float, Array]:
    """Regular polygon with its corners at r, its axis along y."""
    mass = edges / 2 * r**2 * math.sin(2 * math.pi / edges) * length
    axis = mass * r**2 / 6 * (2 + math.cos(2 * math.pi / edges))
    across = axis / 2 + mass * length**2 / 12
    return mass, np.array([across, axis, across])


def without(outer: tuple[float, Array], inner: tuple[float, Array]) -> tuple[float, Array]:
    return outer[0] - inner[0], outer[1] - inner[1]


def dumb_bell(r: float, half: float) -> tuple[float, Array]:
    """Two spheres whose centres are `half` from the middle, along x."""
    mass, moments = sphere(r)
    return 2 * mass, 2 * (moments + mass * half**2 * np.array([0, 1, 1]))


def solid(name: str, shape: str, exact: tuple[float, Array]) -> Variant:
    mass, moments = exact
    energy = 1000 * (mass + float((moments * SPIN**2).sum())) / 2  # at 1 m/s
    return Variant(
        name,
        {SHAPE: f"{{ {shape} }}", MASS: "1000", "models.body.angular_velocity": "[1, 2, 3]", "world.duration": "0.01"},
        {"energy": energy},
    )


def energy_error(run: Outcome) -> float:
    return relative(run.record["ledger"]["energy_J"]["bodies_start"], run["energy"])


BALLS = "shape: { sphere: { radius: 0.1 } }, pose: [%s, 0, 0]"
MASS_PROPERTIES = Case(
    id="R0",
    title="Mass and inertia",
    scene="report/free_flight",
    about="Kinetic energy of solid and hollow shapes, of a mesh (a prism of 128 edges) and of a compound at 1 m/s and (1, 2, 3) rad/s: mass and "
    "all moments of inertia come from the geometry, not from samples.",
    source="closed forms",
    knob=STEP,
    resolutions=(("10s", 1e-3),),
    methods=("ode", "free_body"),
    variants=(
        solid("box", "box: [1.4, 0.9, 0.3]", box(1.4, 0.9, 0.3)),
        solid("sphere", "sphere: { radius: 0.3 }", sphere(0.3)),
        solid("cylinder", "cylinder: { radius: 0.2, length: 0.7 }", cylinder(0.2, 0.7)),
        solid("capsule", "capsule: { radius: 0.2, length: 0.7 }", capsule(0.2, 0.7)),
        solid("hollow-sphere", "hollow_sphere: { radius: 0.3, wall: 0.02 }", without(sphere(0.32), sphere(0.3))),
        solid(
            "hollow-cylinder",
            "hollow_cylinder: { radius: 0.2, length: 0.7, wall: 0.02 }",
            without(cylinder(0.22, 0.74), cylinder(0.2, 0.7)),
        ),
        solid("mesh", "mesh: { file: disc.obj }", prism(128, 1, 1)),
        solid("compound", f"compound: [{{ {BALLS % '-0.5'} }}, {{ {BALLS % '0.5'} }}]", dumb_bell(0.1, 0.5)),
    ),
    measures=(Measure("kinetic energy", "", energy_error, (1e-6,)),),
)

CASES = (MASS_PROPERTIES,)
