"""The metrics of curves whose figures can be derived by hand."""

import unittest

import metrics
from metrics import Curve
from starts import shifts

STEPS = [k / 100 for k in range(2001)]  # to 20 s


def draining(begin, rate, t=STEPS):
    """100 parts, of which `rate` a second leave from `begin` on."""
    return Curve(t, [min(100.0, max(0.0, 100 - rate * (at - begin))) for at in t])


class Metrics(unittest.TestCase):
    def test_a_fraction_has_left_between_two_samples(self):
        self.assertAlmostEqual(metrics.time_of(draining(1, 10), 1 / 4), 3.5)
        self.assertAlmostEqual(metrics.time_of(draining(1, 10, t=[0, 1, 11, 20]), 1 / 4), 3.5)

    def test_the_rate_is_that_of_the_middle_half(self):
        self.assertAlmostEqual(metrics.rate(draining(1, 10)), 10)
        self.assertAlmostEqual(metrics.rate_error(draining(2, 12), draining(1, 10)), 20)

    def test_the_rate_does_not_see_how_it_begins_and_ends(self):
        # 30 parts at once, 60 at 5 a second from 10 s on, and the last 10 at once.
        curve = Curve([0, 1, 1.001, 10, 20, 22, 22.001, 30], [100, 100, 70, 70, 20, 10, 0, 0])
        # 25 have left at 1 s + 25/30 ms, 75 at 10 s + 45/5 s.
        self.assertAlmostEqual(metrics.rate(curve), 50 / (19 - (1 + 0.001 * 25 / 30)))

    def test_what_does_not_drain_has_no_rate_and_no_error(self):
        self.assertIsNone(metrics.rate(draining(1, 1)))
        self.assertIsNone(metrics.rate_error(draining(1, 1), draining(1, 10)))
        self.assertIsNone(metrics.rate_error(draining(1, 10), draining(1, 1)))

    def test_a_curve_has_no_gap_to_itself(self):
        self.assertEqual(metrics.gap(draining(1, 10), draining(1, 10)), 0)

    def test_the_gap_is_taken_until_micro_is_nearly_drained(self):
        # Half a second later: the gap grows from 0 to 5 parts between 1 and 1.5 s and stays until 10.5 s, when micro
        # has 5 % left.
        expected = (0.5 * 5 / 2 + 9 * 5) / 10.5
        self.assertAlmostEqual(metrics.gap(draining(1.5, 10), draining(1, 10)), expected)
        self.assertAlmostEqual(metrics.delay(draining(1.5, 10), draining(1, 10)), 0.5)

    def test_the_gap_is_taken_to_the_end_if_micro_does_not_drain(self):
        # 2 and 1 parts a second from 0 on, for 20 s: the gap grows from 0 to 20.
        self.assertAlmostEqual(metrics.gap(draining(0, 2), draining(0, 1)), 10)

    def test_curves_may_have_different_times(self):
        self.assertAlmostEqual(metrics.gap(draining(1, 10, t=[0, 1, 11, 20]), draining(1, 10)), 0)

    def test_several_starts_have_a_mean_and_a_deviation(self):
        curves = [Curve([0, 1], [9, left]) for left in (1, 2, 6)]
        self.assertEqual(metrics.mean_curve(curves), Curve([0, 1], [9, 3]))
        self.assertEqual(metrics.deviation_curve(curves).upstream, [0, 7 ** 0.5])  # (4 + 1 + 9) / 2

    def test_starts_are_spread_evenly_around_the_nominal_one(self):
        for n in range(1, 10):
            for coordinates in zip(*shifts(n)):
                self.assertAlmostEqual(sum(coordinates), 0)
                self.assertEqual(sorted(coordinates), [(k + 0.5) / n - 0.5 for k in range(n)])


if __name__ == "__main__":
    unittest.main()
