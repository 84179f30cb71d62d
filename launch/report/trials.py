"""Questions that many cases are asked: the same run with one thing of the numerics changed. Each takes the runs to change."""

from case import Trial

ACCURATE = "accuracy: accurate (shorter steps, a stricter solve)"


def strict(*runs: str) -> Trial:
    return Trial("strict", ACCURATE, runs, {"world.accuracy": "accurate"})


def short_steps(*runs: str) -> Trial:
    """Of the explicit solver, at the accuracy that scenes have by default."""
    return Trial("short-steps", "half the length of the steps", runs, {"numerics.courant": "0.25"})


def smooth(*runs: str) -> Trial:
    return Trial("smooth", "no artificial viscosity", runs, {"numerics.artificial_viscosity": "0"})


def damped(*runs: str) -> Trial:
    return Trial("damped", "five times the artificial viscosity", runs, {"numerics.artificial_viscosity": "0.1"})


def less_diffusion(*runs: str) -> Trial:
    return Trial("less-diffusion", "a fifth of the density diffusion", runs, {"numerics.diffusion": "0.02"})


def shifting(*runs: str) -> Trial:
    return Trial("shifting", "particle shifting everywhere", runs, {"numerics.shifting": "always"})


def no_shifting(*runs: str) -> Trial:
    return Trial("no-shifting", "no particle shifting", runs, {"numerics.shifting": "never"})


def wide(*runs: str) -> Trial:
    return Trial("wide", "a kernel of 4 spacings", runs, {"numerics.support": "4"})


def cubic(*runs: str) -> Trial:
    return Trial("cubic", "the cubic spline, 2 spacings wide", runs, {"numerics.kernel": "cubic"})


def nearby(*runs: str, share: float = 0.02) -> Trial:
    """At spacings a little smaller and larger, in which solids cut the lattice otherwise: how much of an error, and so of an
    observed order, is chance."""
    resolutions = [(way, float(h) * (1 + sign * share)) for run in runs for way, _, h in [run.rpartition("/")] for sign in (-1, 1)]
    return Trial("nearby", f"a spacing {100 * share:g} % smaller or larger", tuple(f"{way}/{h:g}" for way, h in resolutions))
