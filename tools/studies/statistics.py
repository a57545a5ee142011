"""Intervals and areas, with numpy and scipy. Quantiles and medians are numpy's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

NORMAL_975 = 1.959963984540054  # quantile of the normal distribution


def clopper_pearson(k: int, n: int, confidence: float = 0.95) -> tuple[float, float]:
    """The exact two-sided interval of a share [clopper1934].

    Args:
        k: successes
        n: trials
        confidence: confidence level, between 0 and 1

    Returns:
        low and high; (0, 1) if n is 0

    Raises:
        ValueError: for k > n or a confidence outside (0, 1)
    """
    if not 0 <= k <= n or not 0.0 < confidence < 1.0:
        raise ValueError(f"no binomial interval of {k} of {n} with confidence {confidence}")
    if n == 0:
        return 0.0, 1.0
    interval = stats.binomtest(k, n).proportion_ci(confidence, method="exact")
    return float(interval.low), float(interval.high)


def quantile(values: ArrayLike, p: float) -> float:
    """The p-quantile, interpolated between the sorted values (numpy's default).

    NaN without values.
    """
    array = np.asarray(values, dtype=float)
    return float(np.quantile(array, p)) if array.size else math.nan


def median(values: ArrayLike) -> float:
    """quantile(values, 0.5) of the values that are not NaN; NaN without values."""
    array = np.asarray(values, dtype=float)
    return quantile(array[~np.isnan(array)], 0.5)


def mean_sd(values: ArrayLike) -> tuple[float, float]:
    """Mean and standard deviation of the sample (n - 1); NaN for too few values."""
    array = np.asarray(values, dtype=float)
    return (float(array.mean()) if array.size else math.nan), (
        float(array.std(ddof=1)) if array.size > 1 else math.nan
    )


@dataclass(frozen=True)
class Auc:
    """Area under the receiver operating curve.

    Attributes:
        value: share of pairs in which the positive has the larger value, ties counting half
        interval: low and high, 95 %
        positives: number of values of that class
        negatives: number of values of the other class
    """

    value: float
    interval: tuple[float, float]
    positives: int
    negatives: int


def _shares_below(values: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """For each value the share of `others` below it, ties counting half."""
    ordered = np.sort(others)
    first, last = (
        np.searchsorted(ordered, values, "left"),
        np.searchsorted(ordered, values, "right"),
    )
    return np.asarray((first + 0.5 * (last - first)) / len(ordered))


def _unbiased(groups: int) -> float:
    """n/(n - 1), which corrects the bias of a variance about its own mean.

    0 for one group, which adds nothing.
    """
    return 0.0 if groups < 2 else groups / (groups - 1)


def auc(
    positives: ArrayLike,
    negatives: ArrayLike,
    positive_group: ArrayLike | None = None,
    negative_group: ArrayLike | None = None,
) -> Auc:
    """The area, exact by ranks, with DeLong's interval [delong1988].

    For values in groups with Obuchowski's [obuchowski1997].

    At 0 and at 1, where DeLong's variance vanishes, the interval is that of clopper_pearson() for
    the groups of the class that has fewer.

    Args:
        positives: [m] values of one class
        negatives: [n] values of the other
        positive_group: [m] group number of each value; None: each value is its own group
        negative_group: [n] likewise

    Returns:
        the area with its interval

    Raises:
        ValueError: for a class without values, a NaN, or groups whose number differs from their
            values
    """
    above_values, below_values = (
        np.asarray(positives, dtype=float),
        np.asarray(negatives, dtype=float),
    )
    m, n = len(above_values), len(below_values)
    if m == 0 or n == 0 or np.isnan(above_values).any() or np.isnan(below_values).any():
        raise ValueError("auc: a class without values, or with a NaN")
    group_p = np.arange(m) if positive_group is None else np.asarray(positive_group)
    group_n = m + np.arange(n) if negative_group is None else np.asarray(negative_group)
    if len(group_p) != m or len(group_n) != n:
        raise ValueError("auc: as many groups as values are needed")
    above, below = (
        _shares_below(above_values, below_values),
        _shares_below(below_values, above_values),
    )
    value = float(above.mean())
    groups = np.unique(np.concatenate([group_p, group_n]))
    of_p = np.bincount(np.searchsorted(groups, group_p), above - value, len(groups))
    of_n = np.bincount(np.searchsorted(groups, group_n), 1.0 - below - value, len(groups))
    with_p, with_n = len(np.unique(group_p)), len(np.unique(group_n))
    if value in (0.0, 1.0):
        pairs = min(with_p, with_n)
        return Auc(value, clopper_pearson(pairs if value == 1.0 else 0, pairs), m, n)
    variance = (
        _unbiased(with_p) * float(of_p @ of_p) / m**2
        + _unbiased(with_n) * float(of_n @ of_n) / n**2
        + 2.0 * _unbiased(len(groups)) * float(of_p @ of_n) / (m * n)
    )
    reach = NORMAL_975 * math.sqrt(max(0.0, variance))
    return Auc(value, (max(0.0, value - reach), min(1.0, value + reach)), m, n)


def median_interval(values: ArrayLike) -> tuple[float, float]:
    """Distribution-free 95 % interval of a median, between two order statistics.

    NaN for fewer than six values.
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    r = 0
    while r < len(ordered) and clopper_pearson(r, len(ordered))[1] <= 0.5:
        r += 1
    return (math.nan, math.nan) if r == 0 else (float(ordered[r - 1]), float(ordered[-r]))


def bootstrap_intervals(
    groups: int, draws: int, seed: int, figures: Callable[[NDArray[np.int64]], Sequence[float]]
) -> list[tuple[float, float]]:
    """Intervals of 95 % by the percentile bootstrap over groups [efron1979].

    Draw number d takes its groups from RandomStream(seed, d, "intervals").

    Args:
        groups: number of groups
        draws: at least 1
        seed: seed of the draws
        figures: computes figures from the numbers [groups] of the drawn groups, equally many each
            time; NaN omits a draw from that figure

    Returns:
        low and high of each figure; NaN for fewer than two groups, and for a figure that is NaN in
        every draw

    Raises:
        ValueError: for no draws
    """
    from slipbench import RandomStream

    if draws < 1:
        raise ValueError("a bootstrap needs a draw")
    rows = []
    for draw in range(draws):
        stream = RandomStream(seed, draw, "intervals")
        rows.append(
            figures(np.array([stream.integer(groups) for _ in range(groups)], dtype=np.int64))
        )
    values = np.asarray(rows, dtype=float)
    if groups < 2:
        return [(math.nan, math.nan)] * values.shape[1]
    columns = [column[~np.isnan(column)] for column in values.T]
    return [(quantile(column, 0.025), quantile(column, 0.975)) for column in columns]
