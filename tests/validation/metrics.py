"""The figures by which two outflow curves are compared. A curve is a list of times and one of parts upstream, U.

    t(q)        first time with U <= (1 - q) N, by linear interpolation; N = U(0)
    rate        N/2 / (t(3/4) - t(1/4)), parts/s
    rate error  100 (rate of macro / rate of micro - 1), %
    gap         100/N times the mean of |U_macro - U_micro| from 0 to the time at which micro has 5 % left, or to the
                end if it has more, %
    delay       t(1/50) of macro minus that of micro, s: positive where macro begins later

What a curve does not come to is None.
"""

from bisect import bisect_left
from dataclasses import dataclass
from math import sqrt

BEGUN = 1 / 50
NEARLY_DRAINED = 19 / 20


@dataclass
class Curve:
    t: list
    upstream: list

    @property
    def n(self):
        return self.upstream[0]


def mean_curve(curves):
    """The mean of curves with the same times."""
    return Curve(curves[0].t, [sum(at) / len(at) for at in zip(*(curve.upstream for curve in curves))])


def deviation_curve(curves):
    """The standard deviation of curves at each of their times."""
    return Curve(curves[0].t, [deviation(at) for at in zip(*(curve.upstream for curve in curves))])


def deviation(values):
    """Sample standard deviation; 0 for one value."""
    mean = sum(values) / len(values)
    return sqrt(sum((value - mean) ** 2 for value in values) / max(len(values) - 1, 1))


def time_of(curve, fraction):
    """When the fraction of the parts has left."""
    level = (1 - fraction) * curve.n
    for i, value in enumerate(curve.upstream):
        if value <= level:
            if i == 0:
                return curve.t[0]
            before = curve.upstream[i - 1]
            return curve.t[i - 1] + (curve.t[i] - curve.t[i - 1]) * (before - level) / (before - value)
    return None


def rate(curve):
    begin, end = time_of(curve, 1 / 4), time_of(curve, 3 / 4)
    return None if end is None else curve.n / 2 / (end - begin)


def rate_error(macro, micro):
    rates = rate(macro), rate(micro)
    return None if None in rates else 100 * (rates[0] / rates[1] - 1)


def value_at(curve, t):
    """U at a time, by linear interpolation; before and after the curve its first and last value."""
    i = min(max(bisect_left(curve.t, t), 1), len(curve.t) - 1)
    weight = min(max((t - curve.t[i - 1]) / (curve.t[i] - curve.t[i - 1]), 0.0), 1.0)
    return (1 - weight) * curve.upstream[i - 1] + weight * curve.upstream[i]


def gap(macro, micro):
    end = time_of(micro, NEARLY_DRAINED)
    times = [t for t in micro.t if end is None or t <= end]
    gaps = [abs(value_at(macro, t) - value_at(micro, t)) for t in times]
    total = sum((times[i] - times[i - 1]) * (gaps[i] + gaps[i - 1]) / 2 for i in range(1, len(times)))
    return 100 * total / (times[-1] - times[0]) / micro.n


def delay(macro, micro):
    times = time_of(macro, BEGUN), time_of(micro, BEGUN)
    return None if None in times else times[0] - times[1]
