"""Figures of cases on rows made by a formula, whose figure is known."""

import tempfile
import unittest
from pathlib import Path

import numpy as np

import cases_contact
import cases_coupled
import cases_experiment
import cases_loads
import cases_waves
from case import Outcome, Variant


class Made(Outcome):
    """A run that never was: times and columns."""

    def __init__(self, t: np.ndarray, columns: dict[str, np.ndarray], references: list[Path] | None = None):
        self.record, self.h, self.variant, self.references = {}, 1.0, Variant(), references or []
        self._columns, self._times = columns, dict.fromkeys(columns, t)


class Measures(unittest.TestCase):
    def test_the_largest_pressure_on_a_face_is_the_top_of_its_profile_not_a_single_row(self):
        t = np.linspace(1e-4, 0.02, 200)
        columns = {f"p{z}": 12500 * np.where(np.floor(z / 500 / t) == 13, 8.0, 5.0) for z in cases_waves.FACE}
        columns["p100"][150] *= 3
        self.assertAlmostEqual(cases_waves.face_pressure(Made(t, columns)), 8.0, delta=0.3)

    def test_a_rate_of_going_round_and_a_radius(self):
        t = np.linspace(0, 10, 501)
        r = 0.25 + 0.001 * t / 10
        run = Made(t, {"disc.x": r * np.cos(1.02 * t), "disc.z": -r * np.sin(1.02 * t)})  # about y, z up
        self.assertAlmostEqual(cases_coupled.round_about(run), 1.02, places=9)
        self.assertAlmostEqual(cases_coupled.radius_drift(run), 0.001, places=9)

    def test_when_a_place_is_first_reached(self):
        t = np.array([0.0, 1, 2, 3])
        self.assertAlmostEqual(cases_experiment.first_at(t, np.array([1.0, 2, 0, 4]), 1.5), 0.5)
        self.assertRaises(ValueError, cases_experiment.first_at, t, np.zeros(4), 1.5)

    def test_time_before_a_pillar_counts_from_the_first_water(self):
        t = np.array([0.0, 0.1, 0.2, 0.3])
        at, v = cases_loads.bore(Made(t, {"bore.vx": np.array([0, 0, 2.0, 1.5])}))
        np.testing.assert_allclose(at, t - 0.2)
        self.assertEqual(v[at >= 0].tolist(), [2.0, 1.5])

    def test_a_centre_of_mass_counts_from_its_own_start(self):
        t = np.linspace(0, 0.5, 51)
        way = {f"{n}.x": 0.1 * k + 0.26 * 0.4 * t for k, n in enumerate(cases_contact.CYLINDERS)}
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / cases_contact.CENTRE.format("x")
            table.write_text("t_s,x_m\n-0.001,0.5\n0.25,0.6\n0.5,0.71\n")
            run = Made(t, way, [Path(folder)])
            self.assertAlmostEqual(cases_contact.centre_error("x", "x")(run), 0.26 * 0.01, places=9)


if __name__ == "__main__":
    unittest.main()
