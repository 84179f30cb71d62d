"""Figures from curves with known answers."""

import math
import unittest

import numpy as np

import metrics


class Curves(unittest.TestCase):
    def setUp(self):
        self.t = np.linspace(0, 10, 5001)

    def test_nrmse_of_a_shifted_curve_is_the_shift_over_the_range(self):
        reference = np.array([1.0, 3.0, 5.0])
        self.assertAlmostEqual(metrics.nrmse(reference + 0.2, reference), 0.05, places=12)

    def test_the_first_row_where_something_holds(self):
        level = np.array([-1, 0, 0.2, -3, 0.4])
        self.assertEqual(metrics.first_row(level > 0, "dry"), 2)
        with self.assertRaisesRegex(metrics.NoFigure, "stays dry"):
            metrics.first_row(level > 1, "the bed stays dry")

    def test_nrmse_of_one_wrong_point_in_four(self):
        reference = np.array([0.0, 1.0, 2.0, 4.0])
        self.assertAlmostEqual(metrics.nrmse(reference + [0, 0, 0, 2], reference), 0.25, places=12)

    def test_resample_is_linear_and_refuses_to_extrapolate(self):
        t, y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 10.0, 0.0])
        np.testing.assert_allclose(metrics.resample(t, y, np.array([0.25, 1.5])), [2.5, 5])
        with self.assertRaises(metrics.NoFigure):
            metrics.resample(t, y, np.array([0.5, 2.5]))

    def test_running_mean_of_a_line_a_spike_and_rows_of_any_distance(self):
        np.testing.assert_allclose(metrics.running_mean(self.t, 3 + 2 * self.t, 0.5)[200:-200], (3 + 2 * self.t)[200:-200])
        np.testing.assert_allclose(metrics.running_mean(self.t, np.full(5001, 7.0), 0.5), 7)
        t = np.array([0, 0.3, 0.4, 0.5, 2.0])
        spike = metrics.running_mean(t, np.array([0, 0, 1, 0, 0]), 0.4)
        np.testing.assert_allclose(spike, [0, 0.25, 0.25, 0.25, 0], atol=1e-15)  # 0.1 of area over 0.4

    def test_period_and_decay_of_a_damped_swing(self):
        y = np.exp(-0.3 * self.t) * np.cos(2 * math.pi * 1.25 * self.t)
        self.assertAlmostEqual(metrics.period(self.t, y), 0.8, places=6)
        self.assertAlmostEqual(metrics.decay_rate(self.t, y), 0.3, places=4)

    def test_period_of_some_half_swings_only(self):
        y = np.where(self.t < 5, np.sin(2 * math.pi * self.t), np.sin(math.pi * self.t))
        self.assertAlmostEqual(metrics.period(self.t, y, 1, 4), 1.0, places=6)

    def test_a_motion_that_does_not_turn_has_no_period(self):
        with self.assertRaises(metrics.NoFigure):
            metrics.period(self.t, 1 + self.t)

    def test_slope_of_a_line(self):
        self.assertAlmostEqual(metrics.slope(self.t, 4 - 2.5 * self.t), -2.5, places=10)

    def test_best_shift_finds_a_late_start(self):
        at = np.linspace(1, 8, 30)
        shift, error = metrics.best_shift(self.t, (self.t - 0.06) ** 2, at, at**2, 0.1)
        self.assertAlmostEqual(shift, 0.06, places=6)
        self.assertLess(error, 1e-5)

    def test_a_start_later_than_allowed_keeps_an_error(self):
        at = np.linspace(1, 8, 30)
        shift, error = metrics.best_shift(self.t, self.t - 0.3, at, at, 0.1)
        self.assertAlmostEqual(shift, 0.1, places=6)
        self.assertAlmostEqual(error, 0.2 / 7, places=6)


class Ranks(unittest.TestCase):
    def test_equal_values_share_their_place(self):
        np.testing.assert_array_equal(metrics.ranks([10, 30, 20, 30]), [1, 3.5, 2, 3.5])

    def test_spearman_by_the_textbook_formula(self):
        # 1 - 6 sum d^2 / (n (n^2 - 1)) where nothing is equal: d = (-1, 1, 0, 0, 0).
        self.assertAlmostEqual(metrics.spearman([1, 2, 3, 4, 5], [20, 10, 30, 50, 70]), 1 - 6 * 2 / (5 * 24), places=12)
        self.assertAlmostEqual(metrics.spearman([1, 2, 3], [1, 1e3, 1e9]), 1, places=12)
        self.assertAlmostEqual(metrics.spearman([1, 2, 3], [9, 5, -2]), -1, places=12)

    def test_what_does_not_vary_has_no_rank_correlation(self):
        self.assertIsNone(metrics.spearman([1, 2, 3], [4, 4, 4]))


class ErrorAgainstTime(unittest.TestCase):
    def test_order_of_a_second_order_method(self):
        self.assertAlmostEqual(metrics.observed_order(0.1, 0.04, 0.05, 0.01), 2, places=12)
        self.assertIsNone(metrics.observed_order(0.1, 0.04, 0.05, 0.0))

    def test_time_to_reach_is_the_geometric_middle_for_the_geometric_middle_of_errors(self):
        self.assertAlmostEqual(metrics.time_to_reach(0.1, [(1, 1.0), (100, 0.01)]), 10, places=9)

    def test_a_fading_swing_settles_to_its_middle_whatever_it_loses(self):
        n = np.arange(8)
        c, q = metrics.settles_to(0.003 + 0.2 * (-0.93) ** n)
        self.assertAlmostEqual(c, 0.003, places=9)
        self.assertAlmostEqual(q, 0.93, places=9)
        # an error of 1 mm in one extreme of eight moves it by less than half of that
        self.assertLess(abs(metrics.settles_to(0.003 + 0.2 * (-0.93) ** n + 1e-3 * (n == 3))[0] - 0.003), 0.5e-3)

    def test_time_to_reach_where_the_cheapest_run_is_good_enough(self):
        self.assertEqual(metrics.time_to_reach(0.1, [(3, 0.05), (30, 0.01)]), 3)

    def test_a_target_that_no_run_meets_has_no_time(self):
        self.assertIsNone(metrics.time_to_reach(1e-3, [(1, 1.0), (100, 0.01)]))

    def test_time_to_reach_does_not_count_on_an_error_that_comes_back(self):
        # 0.02 at 10 s meets it; that 100 s misses it again does not matter, nor does the dearest run decide.
        self.assertAlmostEqual(metrics.time_to_reach(0.2, [(1, 2.0), (10, 0.02), (100, 0.5)]), 10**0.5, places=9)

    def test_pareto_front_leaves_out_what_is_dearer_and_worse(self):
        points = [(10, 0.1), (1, 1.0), (5, 2.0), (100, 0.1), (50, 0.01)]
        self.assertEqual(metrics.pareto_front(points), [1, 0, 4])


if __name__ == "__main__":
    unittest.main()
