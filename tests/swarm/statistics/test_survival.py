"""Times to a threshold, with those that never arrive, against published survival data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate, stats

from swarm.statistics.samples import Curves
from swarm.statistics.survival import CensoredTimes, median_time, restricted_mean_time, times_to_threshold

# Freireich et al. (Blood 21, 1963), weeks of remission;
# the published Kaplan-Meier medians are 23 and 8 weeks.
TREATED = CensoredTimes(
    np.array([6, 6, 6, 7, 10, 13, 16, 22, 23, 6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35], float),
    np.array([True] * 9 + [False] * 12),
)
PLACEBO = CensoredTimes(
    np.array([1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23], float),
    np.ones(21, bool),
)


def curves() -> Curves:
    values = np.array([[9.0, 4, 5, 4, 4], [9, 9, 9, 9, 9], [3, 3, 3, 3, 3]])
    return Curves("length", np.array([10.0, 20, 30, 40, 50]), values, (0, 1, 2))


def test_the_first_arrival_and_those_that_never_arrive() -> None:
    censored = times_to_threshold(curves(), 4)
    assert censored.times.tolist() == [20, 50, 10]
    assert censored.observed.tolist() == [True, False, True]


def test_an_arrival_that_lasts() -> None:
    assert times_to_threshold(curves(), 4, lasting=True).times.tolist() == [40, 50, 10]


def test_the_published_medians() -> None:
    assert median_time(TREATED) == 23
    assert median_time(PLACEBO) == 8


def test_no_median_when_fewer_than_half_arrive() -> None:
    assert median_time(CensoredTimes(np.array([1.0, 9, 9]), np.array([True, False, False]))) is None
    assert median_time(CensoredTimes(np.array([9.0, 9, 9]), np.zeros(3, bool))) is None


def test_the_restricted_mean_is_the_area_under_kaplan_and_meiers_curve() -> None:
    mean = restricted_mean_time(TREATED, 35)
    data = stats.CensoredData(TREATED.times[TREATED.observed], right=TREATED.times[~TREATED.observed])
    survival = stats.ecdf(data).sf
    weeks = np.linspace(0, 35, 350_001)
    assert mean.time == pytest.approx(integrate.trapezoid(survival.evaluate(weeks), weeks), abs=1e-3)
    assert mean.time == pytest.approx(
        23.287, abs=1e-3
    )  # R: print(survfit(...), rmean = 35), standard error 2.83
    assert (mean.high - mean.low) / 2 / 1.959964 == pytest.approx(2.827, abs=1e-3)


def test_without_censoring_the_restricted_mean_is_the_mean() -> None:
    mean = restricted_mean_time(PLACEBO, 23)
    error = PLACEBO.times.std() / np.sqrt(21)
    assert mean.time == pytest.approx(PLACEBO.times.mean())
    assert mean.high - mean.low == pytest.approx(2 * 1.959964 * error, rel=1e-6)


def test_an_arrival_counts_as_the_horizon_at_most() -> None:
    never = CensoredTimes(np.array([50.0, 50]), np.zeros(2, bool))
    mean = restricted_mean_time(never, 50)
    assert (mean.time, mean.low, mean.high) == (50, 50, 50)
