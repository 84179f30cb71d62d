"""Exact answers, computed from their formulas, and published tables where there is none."""

import math
from pathlib import Path

import numpy as np

Array = np.ndarray


class ReferenceMissing(Exception):
    """A table that may not be carried along is not in any of the folders: its name."""


def read_table(name: str, folders: list[Path]) -> dict[str, Array]:
    """Columns of a CSV file by the words of its header; lines with # in front are comments."""
    for folder in folders:
        if (folder / name).is_file():
            lines = [x for x in (folder / name).read_text().splitlines() if x and not x.startswith("#")]
            values = np.array([[float(v) for v in line.split(",")] for line in lines[1:]])
            return dict(zip(lines[0].split(","), values.T))
    raise ReferenceMissing(name)


def where_looked(folders: list[Path]) -> str:
    return f"looked for in {' and '.join(str(f) for f in folders)}; give their folder with --references"


def elliptic_k(modulus: float) -> float:
    """Complete elliptic integral of the first kind K(k), by the arithmetic-geometric mean."""
    a, b = 1.0, math.sqrt(1 - modulus**2)
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (2 * a)


def pendulum_period(small: float, angle: float) -> float:
    """Period of a pendulum let go at `angle` (rad); `small` is its period for small swings, s."""
    return small * 2 / math.pi * elliptic_k(math.sin(angle / 2))


def sliding(times: Array, speed: float, acceleration: float) -> Array:
    """Way on a plane; what slows down stays where it stops, as Coulomb's friction has it."""
    stop = -speed / acceleration if acceleration < 0 else math.inf
    t = np.minimum(times, stop)
    return speed * t + acceleration * t**2 / 2


def bouncing(times: Array, height: float, restitution: float, g: float = 9.81) -> Array:
    """Height over the floor of a ball dropped from `height`; flights of e, e^2 ... times the speed of the first impact."""
    out, speed, start = height - g * times**2 / 2, math.sqrt(2 * g * height), math.sqrt(2 * height / g)
    while start <= times[-1]:
        speed *= restitution
        out = np.where(times >= start, speed * (times - start) - g * (times - start) ** 2 / 2, out)
        if 2 * speed / g < 1e-9:  # at rest
            return np.where(times >= start, 0.0, out)
        start += 2 * speed / g
    return out


def hinge_moment(depth: float, density: float = 1000, g: float = 9.81) -> float:
    """Of still water on one side of an upright gate, about a hinge at the bed, N m per metre: rho g H^3 / 6."""
    return density * g * depth**3 / 6


def rest_time(height: float, restitution: float, g: float = 9.81) -> float:
    """When that ball is at rest: the sum of all flights."""
    return math.sqrt(2 * height / g) * (1 + restitution) / (1 - restitution)


def comes_to_roll(speed: float, friction: float, g: float = 9.81) -> float:
    """When a sphere that starts without spin on a level plane no longer slides; its speed is 5/7 of the first one then."""
    return 2 * speed / (7 * friction * g)


def sliding_then_rolling(times: Array, speed: float, friction: float, g: float = 9.81) -> Array:
    """Way of that sphere."""
    rolls = comes_to_roll(speed, friction, g)
    t = np.minimum(times, rolls)
    return speed * t - friction * g * t**2 / 2 + 5 / 7 * speed * np.maximum(times - rolls, 0)


def added_mass(shape: str, q: float) -> float:
    """Inviscid added mass over displaced fluid mass in a concentric container q times as wide (Lamb, art. 93)."""
    return (q**2 + 1) / (q**2 - 1) if shape == "cylinder" else 0.5 * (q**3 + 2) / (q**3 - 1)


def released(ratio: Array, coefficient: float) -> Array:
    """First acceleration over g, downwards, of a body of `ratio` times the fluid's density."""
    return (ratio - 1) / (ratio + coefficient)


def _below(corners: Array, level: float) -> Array:
    """The part of a convex polygon that lies below a level; corners (x, z) in order."""
    out = []
    for (x0, z0), (x1, z1) in zip(corners, np.roll(corners, -1, axis=0)):
        if z0 <= level:
            out.append((x0, z0))
        if (z0 - level) * (z1 - level) < 0:
            out.append((x0 + (x1 - x0) * (level - z0) / (z1 - z0), level))
    return np.array(out)


def _area_and_middle(corners: Array) -> tuple[float, float]:
    """Of a polygon: its area, and x of its centroid."""
    (x0, z0), (x1, z1) = corners.T, np.roll(corners, -1, axis=0).T
    cross = x0 * z1 - x1 * z0
    return float(cross.sum()) / 2, float(((x0 + x1) * cross).sum() / (3 * cross.sum()))


def righting_lever(ratio: float, angle: float) -> float:
    """Of a floating square of side 1 and `ratio` times the water's density, turned by `angle` (rad): how far the centroid of
    what is immersed lies to the side of its own. Negative: it turns on."""
    c, s = math.cos(angle), math.sin(angle)
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) @ np.array([[c, -s], [s, c]])
    low, high = square[:, 1].min(), square[:, 1].max()
    for _ in range(100):
        level = (low + high) / 2
        part = _below(square, level)
        if len(part) > 2 and _area_and_middle(part)[0] > ratio:
            high = level
        else:
            low = level
    return _area_and_middle(_below(square, high))[1]


def rest_angle(ratio: float) -> float:
    """At which that square floats stably, between 0 and pi / 4 (rad)."""
    low, high = 1e-4, math.pi / 4
    if righting_lever(ratio, low) > 0:
        return 0.0
    if righting_lever(ratio, high - 1e-4) < 0:
        return high
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if righting_lever(ratio, middle) < 0 else (low, middle)
    return low


def channel_startup(y: Array, t: float, terms: int = 200) -> tuple[Array, Array]:
    """Start-up of plane Poiseuille flow (u nu / F L^2) and plane Couette flow (u / U0) at y / L and t nu / L^2.

    J.P. Morris, P.J. Fox, Y. Zhu, J. Comput. Phys. 136 (1997) 214-226.
    """
    poiseuille, couette = y * (1 - y) / 2, y.astype(float)
    for n in range(1, terms + 1):
        couette = couette + 2 / (n * math.pi) * (-1) ** n * np.sin(n * math.pi * y) * math.exp(
            -((n * math.pi) ** 2) * t
        )
        if n % 2:
            k = n * math.pi
            poiseuille = poiseuille - 4 / k**3 * np.sin(k * y) * math.exp(-(k**2) * t)
    return poiseuille, couette


def sloshing_period(length: float, depth: float, mode: int, g: float = 9.81) -> float:
    """Period of a standing wave of small amplitude: omega^2 = g k tanh(k depth), k = mode pi / length."""
    k = mode * math.pi / length
    return 2 * math.pi / math.sqrt(g * k * math.tanh(k * depth))


def piston_root(mass_ratio: float) -> float:
    """q of q tan q = m_fluid / m_body in (0, pi/2): first mode of a piston on a closed acoustic column."""
    low, high = 0.0, math.pi / 2
    for _ in range(200):
        middle = (low + high) / 2
        if middle * math.tan(middle) < 1 / mass_ratio:
            low = middle
        else:
            high = middle
    return low


def _evolve(state: Array, mass: Array, stiffness: Array, times: Array) -> Array:
    """Rows of the solution of mass u' = -stiffness u at `times`; mass diagonal, stiffness symmetric: exact in time."""
    root = np.sqrt(mass)
    rates, modes = np.linalg.eigh(stiffness / np.outer(root, root))
    return (modes @ (np.exp(-np.outer(rates, times)) * (modes.T @ (root * state))[:, None])).T / root


def _shear_chain(inertia: float, cell_mass: Array, links: Array) -> tuple[Array, Array]:
    """Body, then cells outwards to a fixed wall; links[i] joins i and i + 1, the last one the wall."""
    size = cell_mass.size + 1
    stiffness = np.zeros((size, size))
    for i, link in enumerate(links):
        stiffness[i, i] += link
        if i + 1 < size:
            stiffness[i + 1, i + 1] += link
            stiffness[i, i + 1] -= link
            stiffness[i + 1, i] -= link
    return np.concatenate([[inertia], cell_mass]), stiffness


def plate_between_walls(
    ratio: float, times: Array, cells: int = 400, gap: float = 0.1, thickness: float = 0.02, nu: float = 1e-3
) -> Array:
    """u/u0 of a free plate half-way between two walls, `ratio` times as dense as the fluid; finite volumes."""
    dy = gap / cells
    links = np.full(cells + 1, nu / dy)
    links[[0, -1]] *= 2
    mass, stiffness = _shear_chain(ratio * thickness / 2, np.full(cells, dy), links)
    start = np.zeros(cells + 1)
    start[0] = 1
    return _evolve(start, mass, stiffness, times)[:, 0]


def annulus_spin_down(
    ratio: float, times: Array, cells: int = 400, a: float = 0.1, b: float = 0.2, nu: float = 1e-3
) -> Array:
    """omega/omega0 of a free cylinder in a fixed concentric one; finite volumes in the angular velocity w:
    r^3 w_t = nu (r^3 w_r)_r, and (ratio a^4 / 4) w_t = nu a^3 w_r at the body."""
    edges = np.linspace(a, b, cells + 1)
    middle = (edges[:-1] + edges[1:]) / 2
    distance = np.diff(np.concatenate([[a], middle, [b]]))
    mass, stiffness = _shear_chain(
        ratio * a**4 / 4, (edges[1:] ** 4 - edges[:-1] ** 4) / 4, nu * edges**3 / distance
    )
    start = np.zeros(cells + 1)
    start[0] = 1
    return _evolve(start, mass, stiffness, times)[:, 0]


def tumbling(inertia: Array, omega: Array, times: Array, step: float = 1e-3) -> Array:
    """Angular velocity in the body frame of a free body, Euler's equations by classical Runge-Kutta; one row a time."""

    def rate(w: Array) -> Array:
        return -np.cross(w, inertia * w) / inertia

    rows, w, now = [], np.array(omega, float), 0.0
    for t in times:
        for _ in range(max(0, math.ceil((t - now) / step - 1e-9))):
            h = min(step, t - now)
            k1 = rate(w)
            k2 = rate(w + h / 2 * k1)
            k3 = rate(w + h / 2 * k2)
            k4 = rate(w + h * k3)
            w, now = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), now + h
        rows.append(w)
    return np.array(rows)


def first_flip(inertia: tuple[float, float, float], omega: tuple[float, float, float]) -> float:
    """When a free body with moments of inertia 1 < 2 < 3 first turns over, that starts with 0 about its third axis and little
    about the first; then every two of these quarter periods. Jacobi's solution for an angular momentum below sqrt(2 T I_2),
    L.D. Landau and E.M. Lifshitz, Mechanics, section 37."""
    i1, i2, i3 = inertia
    twice_energy = sum(i * w**2 for i, w in zip(inertia, omega))
    square = sum((i * w) ** 2 for i, w in zip(inertia, omega))
    if omega[2] != 0 or not i1 < i2 < i3 or not i1 * twice_energy < square < i2 * twice_energy:
        raise ValueError("no such start")
    rate = math.sqrt((i2 - i1) * (i3 * twice_energy - square) / (i1 * i2 * i3))
    modulus = math.sqrt((i3 - i2) * (square - i1 * twice_energy) / ((i2 - i1) * (i3 * twice_energy - square)))
    return elliptic_k(modulus) / rate


def martin_moyce() -> tuple[Array, Array]:
    """Surge front of a collapsing column twice as high as wide: t sqrt(2 g / a) and z / a, a = 0.05715 m.

    J.C. Martin and W.J. Moyce, Phil. Trans. R. Soc. Lond. A 244 (1952) 312-324, as commonly tabulated.
    """
    t = [0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.2, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33]
    z = [1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3, 3.22, 3.44, 3.67, 3.89, 4.11]
    return np.array(t), np.array(z)


def drop_axes(strain: float, attraction: float, times: Array, step: float = 1e-3) -> tuple[Array, Array]:
    """Semi-axes a (along x) and b over the radius of a drop of inviscid fluid that starts as a circle with
    v = strain (x, -z), pulled to its centre with attraction^2 r; an ellipse at all times. `step` in 1 / strain.

    J.J. Monaghan and A. Rafiee, Int. J. Numer. Meth. Fluids 71 (2013) 537-561; attraction 0: J.J. Monaghan,
    J. Comput. Phys. 110 (1994) 399-406.
    """

    def rate(s: Array) -> Array:
        big, a, b = s
        return np.array([(big**2 + attraction**2) * (b**2 - a**2) / (a**2 + b**2), big * a, -big * b])

    rows, s, now = [], np.array([strain, 1.0, 1.0]), 0.0
    for t in times:
        count = max(0, math.ceil((t - now) * abs(strain) / step - 1e-9))
        for _ in range(count):
            h = (t - now) / count
            k1 = rate(s)
            k2 = rate(s + h / 2 * k1)
            k3 = rate(s + h / 2 * k2)
            k4 = rate(s + h * k3)
            s = s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        now = t
        rows.append(s[1:])
    a, b = np.array(rows).T
    return a, b


def square_patch_pressure(terms: int = 200) -> float:
    """p / (rho omega^2 L^2) in the middle of a square of fluid that starts to turn rigidly: lap p = 2 rho omega^2, 0 at
    the rim, by its double sine series."""
    total = 0.0
    for m in range(1, terms, 2):
        for n in range(1, terms, 2):
            total += (-1) ** ((m + n) // 2 - 1) / (m * n * (m * m + n * n))
    return -32 / math.pi**4 * total


# A. ten Cate et al., Phys. Fluids 14 (2002) 4012-4025, tables I and II: by case the fluid's density (kg/m^3), viscosity (Pa s),
# speed of the same sphere in an endless fluid (m/s), and the largest speed measured over it.
TEN_CATE = {
    "E1": (970, 0.373, 0.038, 0.947),
    "E2": (965, 0.212, 0.060, 0.953),
    "E3": (962, 0.113, 0.091, 0.959),
    "E4": (960, 0.058, 0.128, 0.955),
}


def slamming(submergence: Array) -> Array:
    """F / (rho D V^2 / 2) per length of a cylinder that enters water at constant speed; submergence of its lowest point over D.

    I.M.C. Campbell and P.A. Weynberg (1980), in the form of DNV-RP-C205.
    """
    return 5.15 * (1 / (1 + 19 * submergence) + 0.107 * submergence)
