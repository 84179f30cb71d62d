"""Exact answers against published values, against conditions that they must meet, and against each other."""

import math
import tempfile
import unittest
from pathlib import Path

import numpy as np

import references


class Formulas(unittest.TestCase):
    def test_elliptic_integral(self):
        # Abramowitz and Stegun, table 17.1: K at modular angles 0, 45 and 80 degrees.
        for degrees, value in ((0, 1.57079632679), (45, 1.85407467730), (80, 3.15338525189)):
            self.assertAlmostEqual(references.elliptic_k(math.sin(math.radians(degrees))), value, places=10)

    def test_pendulum_by_its_series(self):
        a = math.radians(30)
        series = 1 + a**2 / 16 + 11 * a**4 / 3072 + 173 * a**6 / 737280 + 22931 * a**8 / 1321205760
        self.assertAlmostEqual(references.pendulum_period(2, a), 2 * series, places=8)

    def test_slamming_between_wagner_and_deep(self):
        # As tabulated; the least is where 19 / (1 + 19 s)^2 = 0.107.
        np.testing.assert_allclose(references.slamming(np.array([0, 0.05, 0.5])), [5.15, 2.6686, 0.766], atol=5e-5)
        deep = (math.sqrt(19 / 0.107) - 1) / 19
        s = np.linspace(0, 1, 10001)
        self.assertAlmostEqual(s[np.argmin(references.slamming(s))], deep, places=3)

    def test_added_mass_far_from_a_wall_and_near(self):
        self.assertAlmostEqual(references.added_mass("cylinder", 1e4), 1, places=7)
        self.assertAlmostEqual(references.added_mass("sphere", 1e4), 0.5, places=7)
        self.assertAlmostEqual(references.added_mass("cylinder", 2), 5 / 3, places=14)
        self.assertAlmostEqual(references.added_mass("sphere", 2), 5 / 7, places=14)

    def test_added_mass_by_the_potential(self):
        # Per radius and speed: phi = (A r + B / r^n) cos, n = 1 (cylinder) or 2 (sphere); dphi / dr = cos at the body, 0 at the wall.
        for shape, n in (("cylinder", 1), ("sphere", 2)):
            for q in (1.5, 2, 5):
                a, b = np.linalg.solve([[1, -n], [1, -n * q ** (-n - 1)]], [1, 0])
                self.assertAlmostEqual(-(a + b), references.added_mass(shape, q), places=12)

    def test_a_floating_square(self):
        # Upright: GM = KB + BM - KG. Waterline across two opposite sides: GM + BM / 2 tan^2 = 0. 45 degrees from 9 / 32 on.
        rest = lambda ratio: math.degrees(references.rest_angle(ratio))
        self.assertEqual(rest(0.2), 0)  # GM > 0 where 6 s (1 - s) < 1: s < 0.2113
        half = 1 / (12 * 0.23)
        exact = math.degrees(math.atan(math.sqrt(-2 * (0.23 / 2 + half - 0.5) / half)))
        self.assertAlmostEqual(rest(0.23), exact, places=4)
        self.assertLess(rest(9 / 32 - 1e-3), 44)
        for ratio in (9 / 32 + 1e-3, 0.3, 0.5, 0.7):
            self.assertAlmostEqual(rest(ratio), 45, places=9)
        small = 1e-4
        gm = 0.35 + 1 / (12 * 0.7) - 0.5
        self.assertAlmostEqual(references.righting_lever(0.7, small) / small, gm, places=5)

    def test_a_block_slides_to_where_friction_stops_it(self):
        mu, g, times = 0.3, 9.81, np.array([0.0, 0.1, 0.5, 2.0])
        way = references.sliding(times, 2, -mu * g)
        np.testing.assert_allclose(way[:2], [0, 0.2 - mu * g * 0.005], atol=1e-15)
        self.assertAlmostEqual(way[3], 2**2 / (2 * mu * g), places=12)
        np.testing.assert_allclose(references.sliding(times, 0, 3.0), 1.5 * times**2)

    def test_a_ball_bounces_to_the_square_of_restitution_and_comes_to_rest(self):
        e, fall = 0.5, math.sqrt(2 / 9.81)
        rest = references.rest_time(1, e)
        self.assertAlmostEqual(rest, 1.354571, places=6)
        self.assertAlmostEqual(rest, fall + sum(2 * fall * e**n for n in range(1, 60)), places=12)
        apex = fall * (1 + e)  # of the first rebound
        height = references.bouncing(np.array([0, fall, apex, rest + 1e-6, 2]), 1, e)
        np.testing.assert_allclose(height[:3], [1, 0, e**2], atol=1e-12)
        np.testing.assert_allclose(height[3:], 0, atol=1e-12)
        whole = references.bouncing(np.linspace(0, 4 * fall, 5), 1, 1)
        np.testing.assert_allclose(whole, [1, 0, 1, 0, 1], atol=1e-12)

    def test_channel_starts_at_rest_and_ends_steady(self):
        y = np.linspace(0, 1, 11)
        poiseuille, couette = references.channel_startup(y, 5.0)
        np.testing.assert_allclose(poiseuille, y * (1 - y) / 2, atol=1e-12)
        np.testing.assert_allclose(couette, y, atol=1e-12)
        # Morris et al. 1997: a wall far away is not felt yet, u = F t.
        poiseuille, couette = references.channel_startup(np.array([0.5]), 0.01)
        self.assertAlmostEqual(poiseuille[0], 0.01, places=5)
        self.assertAlmostEqual(couette[0], math.erfc(0.5 / 2 / math.sqrt(0.01)), places=9)

    def test_sloshing_in_deep_and_shallow_water(self):
        self.assertAlmostEqual(
            references.sloshing_period(2, 100, 2), 2 * math.pi / math.sqrt(9.81 * math.pi), places=10
        )
        self.assertAlmostEqual(references.sloshing_period(1, 1e-3, 1), 2 / math.sqrt(9.81e-3), places=4)

    def test_a_sphere_slides_until_its_foot_stands_still(self):
        # By its equations of motion: v' = -mu g, r w' = 5/2 mu g until v = r w.
        v, spin, way, t, dt = 2.0, 0.0, 0.0, 0.0, 1e-5
        while v > spin:
            v, spin, way, t = v - 0.981 * dt, spin + 2.4525 * dt, way + v * dt, t + dt
        self.assertAlmostEqual(references.comes_to_roll(2, 0.1), t, delta=2e-5)
        self.assertAlmostEqual(v, 10 / 7, delta=2e-5)
        ways = references.sliding_then_rolling(np.array([0.0, t, t + 0.1]), 2, 0.1)
        np.testing.assert_allclose(ways, [0, way, way + v * 0.1], atol=1e-4)

    def test_a_gate_bears_its_pressure_at_a_third_of_the_depth(self):
        z = (np.arange(1000) + 0.5) / 2000  # m over the hinge
        self.assertAlmostEqual(references.hinge_moment(0.5), float(9810 * ((0.5 - z) * z).sum() / 2000), delta=1e-3)

    def test_piston_root(self):
        for ratio in (0.01, 1, 100):
            q = references.piston_root(ratio)
            self.assertAlmostEqual(ratio * q * math.tan(q), 1, places=9)
        self.assertAlmostEqual(
            references.piston_root(1), 0.86033358901938, places=12
        )  # Abramowitz and Stegun, table 4.20


class Diffusion(unittest.TestCase):
    def test_a_massive_plate_slows_down_by_the_shear_of_a_half_space(self):
        # Before the walls are felt: sigma u' = -2 mu u0 / sqrt(pi nu t), so u = u0 (1 - 4 mu sqrt(t / (pi nu)) / sigma).
        ratio, t, nu = 1e4, 0.2, 1e-3
        loss = 4 * nu * math.sqrt(t / (math.pi * nu)) / (ratio * 0.02)
        got = 1 - references.plate_between_walls(ratio, np.array([t]), 800)[0]
        self.assertAlmostEqual(got / loss, 1, delta=5e-3)  # the grid's share at this early time

    def test_a_massive_plate_ends_with_the_decay_of_steady_shear(self):
        # u' = -2 nu / (gap thickness ratio) u once the profile between plate and wall is linear.
        ratio = 1e4
        u = references.plate_between_walls(ratio, np.array([50.0, 100.0]))
        self.assertAlmostEqual(math.log(u[0] / u[1]) / 50 / (2 * 1e-3 / (0.1 * 0.02 * ratio)), 1, places=3)

    def test_a_massive_cylinder_ends_with_the_decay_of_steady_couette_flow(self):
        # Torque 4 pi mu a^2 b^2 / (b^2 - a^2) omega over the moment ratio rho pi a^4 / 2.
        ratio, a, b = 1e4, 0.1, 0.2
        w = references.annulus_spin_down(ratio, np.array([50.0, 100.0]))
        rate = 4e-3 * b**2 / (b**2 - a**2) / (ratio * a**2 / 2)
        self.assertAlmostEqual(math.log(w[0] / w[1]) / 50 / rate, 1, places=3)

    def test_twice_the_cells_change_nothing(self):
        times = np.array([0.1, 1.0])
        for solve in (references.plate_between_walls, references.annulus_spin_down):
            np.testing.assert_allclose(solve(1, times, 400), solve(1, times, 200), atol=2e-4)


class Tumbling(unittest.TestCase):
    def test_a_symmetric_top_precesses(self):
        # I1 = I2 = 1, I3 = 2: w1 + i w2 turns at (I3 - I1) / I1 w3.
        w = references.tumbling(np.array([1.0, 1.0, 2.0]), np.array([0.1, 0.0, 3.0]), np.array([0.0, 1.0]))[1]
        np.testing.assert_allclose(w, [0.1 * math.cos(3), 0.1 * math.sin(3), 3], atol=1e-9)

    def test_energy_and_momentum_stay(self):
        inertia = np.array([1.0, 2.0, 3.0])
        w = references.tumbling(inertia, np.array([0.01, 1, 0]), np.array([0.0, 10.0, 20.0]), 1e-2)
        np.testing.assert_allclose((inertia * w**2).sum(1), 2.0001, atol=1e-8)
        np.testing.assert_allclose(((inertia * w) ** 2).sum(1), 4.0001, atol=1e-8)

    def test_flips_are_those_of_the_equations_and_of_the_table(self):
        first = references.first_flip((1, 2, 3), (0.01, 1, 0))
        for number, published in enumerate((10.377305, 31.131915, 51.886524, 72.641134, 93.395744)):
            self.assertAlmostEqual((2 * number + 1) * first, published, places=6)
        w = references.tumbling(np.array([1.0, 2, 3]), np.array([0.01, 1, 0]), np.array([first, 2 * first]), 1e-2)[:, 1]
        np.testing.assert_allclose(w, [0, -1], atol=1e-7)
        self.assertRaises(ValueError, references.first_flip, (1, 2, 3), (0, 1, 0.01))


class Drops(unittest.TestCase):
    def test_a_stretching_drop_at_the_published_time(self):
        # J.J. Monaghan, J. Comput. Phys. 110 (1994): semi-axis 1.9445 after 7.6 ms at 100 1/s.
        a, b = references.drop_axes(-100, 0, np.array([0.0, 0.0076]))
        self.assertAlmostEqual(b[1], 1.9445, places=4)
        np.testing.assert_allclose(a * b, 1, atol=1e-9)

    def test_a_swinging_drop_keeps_its_energy(self):
        # Per mass over R^2: (A^2 + B^2) (a^2 + b^2) / 8; at the largest stretch A = 0 and a^2 + 1 / a^2 = 2.5.
        a, _ = references.drop_axes(0.5, 1, np.linspace(0, 4.57, 2000))
        self.assertAlmostEqual(a.max(), 2**0.5, places=5)
        self.assertAlmostEqual(a.min(), 0.5**0.5, places=5)
        self.assertAlmostEqual(a[-1], 1, places=2)

    def test_suction_in_a_square_patch(self):
        # Torsion of a square bar: Prandtl's stress function of lap phi = -2 G theta is 0.1473 G theta a^2 in the middle.
        self.assertAlmostEqual(references.square_patch_pressure(), -0.14734, places=5)


class Tables(unittest.TestCase):
    def test_comments_are_skipped_and_columns_named(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.csv").write_text("# words, more\n# units\nt_s,x_m\n0,1\n0.5,2\n")
            table = references.read_table("a.csv", [Path(folder) / "none", Path(folder)])
            np.testing.assert_array_equal(table["x_m"], [1, 2])

    def test_a_table_that_is_not_there_is_said_to_be_missing(self):
        with self.assertRaisesRegex(references.ReferenceMissing, "^none.csv$"):
            references.read_table("none.csv", [Path("nowhere")])
        self.assertIn("looked for in nowhere and here; ", references.where_looked([Path("nowhere"), Path("here")]))


if __name__ == "__main__":
    unittest.main()
