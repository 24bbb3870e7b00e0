"""Averages, areas and bands against scipy, published values and their own promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from swarm.errors import UserError
from swarm.statistics.intervals import (
    average,
    bootstrap_bands,
    pointwise_t_band,
    simultaneous_band,
    weighted_iqm,
    weighted_mean,
)
from swarm.statistics.samples import Curves, Sample, area_under_curve, average_of_learners, mean_level


def random_walks(seed: int, replicates: int, points: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(replicates, points)).cumsum(axis=1)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([5, 8, 4, 38, 8, 6, 9, 7, 7, 3, 1, 6], 6.5),  # the textbook example of the interquartile mean
        ([1, 3, 5, 7, 9, 11, 13, 15, 17], 9.0),  # 9 observations: quartiles cut through two of them
        ([1, 2, 3, 4, 5], 3.0),
    ],
)
def test_the_interquartile_mean_of_published_examples(values: list[float], expected: float) -> None:
    assert average(np.array(values, float)[:, None], weighted_iqm)[0] == pytest.approx(expected)


def test_the_interquartile_mean_is_scipys_trimmed_mean() -> None:
    values = random_walks(1, 40, 7)
    np.testing.assert_allclose(average(values, weighted_iqm), stats.trim_mean(values, 0.25, axis=0))


def test_weights_count_a_replicate_that_often() -> None:
    values = random_walks(2, 5, 3)
    weights = np.array([[2.0, 0, 1, 1, 4]])
    repeated = np.repeat(values, [2, 0, 1, 1, 4], axis=0)
    np.testing.assert_allclose(weighted_mean(weights, values)[0], repeated.mean(axis=0))
    np.testing.assert_allclose(weighted_iqm(weights, values)[0], average(repeated, weighted_iqm))


def test_the_pointwise_band_is_scipys_t_interval() -> None:
    values = random_walks(3, 12, 5)
    band = pointwise_t_band(values)
    interval = stats.ttest_1samp(values, 0).confidence_interval(0.95)
    np.testing.assert_allclose(band.low, interval.low)
    np.testing.assert_allclose(band.high, interval.high)


def covers(band_low: np.ndarray, band_high: np.ndarray) -> bool:
    return bool(np.all((band_low <= 0) & (band_high >= 0)))


def test_only_the_simultaneous_band_covers_the_whole_curve_with_its_level() -> None:
    rng = np.random.default_rng(4)
    whole, pointwise, trials = 0, 0, 200
    for trial in range(trials):
        values = random_walks(100 + trial, 30, 50)
        band, narrow = simultaneous_band(values, rng, resamples=400), pointwise_t_band(values)
        whole += covers(band.low, band.high)
        pointwise += covers(narrow.low, narrow.high)
    assert stats.binomtest(whole, trials, 0.95).pvalue > 0.01
    assert pointwise / trials < 0.9


def test_bootstrap_bands_of_the_mean_agree_with_student() -> None:
    values = np.random.default_rng(5).normal(3, 2, size=(200, 4))
    percentile, simultaneous = bootstrap_bands(values, np.random.default_rng(6))
    student = pointwise_t_band(values)
    np.testing.assert_allclose(percentile.low, student.low, atol=0.05)
    np.testing.assert_allclose(percentile.high, student.high, atol=0.05)
    assert np.all(simultaneous.low < percentile.low)
    assert np.all(simultaneous.high > percentile.high)


def test_the_bootstrap_band_of_the_iqm_agrees_with_scipys_bootstrap() -> None:
    values = np.random.default_rng(7).exponential(size=(60, 1))
    band, _ = bootstrap_bands(values, np.random.default_rng(8), weighted_iqm, resamples=4000)
    reference = stats.bootstrap(
        (values[:, 0],),
        lambda sample, axis: stats.trim_mean(sample, 0.25, axis=axis),
        method="percentile",
        n_resamples=4000,
        rng=np.random.default_rng(9),
    ).confidence_interval
    assert band.low[0] == pytest.approx(reference.low, abs=0.03)
    assert band.high[0] == pytest.approx(reference.high, abs=0.03)


def test_a_band_is_the_same_for_the_same_generator() -> None:
    values = random_walks(10, 9, 6)
    first, second = (simultaneous_band(values, np.random.default_rng(1)) for _ in range(2))
    np.testing.assert_array_equal(first.high, second.high)


def test_a_point_at_which_all_replicates_agree_has_a_band_of_no_width() -> None:
    values = random_walks(11, 9, 6)
    values[:, 2] = 9.1
    band = simultaneous_band(values, np.random.default_rng(1))
    assert band.low[2] == band.high[2] == pytest.approx(9.1)
    assert band.high[3] - band.low[3] < 50


def test_one_replicate_has_no_interval() -> None:
    with pytest.raises(UserError, match="at least 2 replicates; got 1"):
        pointwise_t_band(np.ones((1, 3)))


def test_the_area_under_known_curves() -> None:
    curves = Curves("ramp", np.array([0.0, 1, 3]), np.array([[0.0, 1, 3], [2, 2, 2]]), (0, 1))
    np.testing.assert_allclose(area_under_curve(curves).values, [4.5, 6.0])
    np.testing.assert_allclose(mean_level(curves).values, [4 / 3, 2.0])


def test_curves_can_be_cut_and_thinned() -> None:
    curves = Curves("walk", np.arange(1.0, 11), random_walks(12, 2, 10), (0, 1))
    assert curves.between(3, 6).times.tolist() == [3, 4, 5, 6]
    assert curves.every(5).times.tolist() == [5, 10]
    np.testing.assert_array_equal(curves.every(5).values, curves.values[:, [4, 9]])


def test_two_learners_that_copy_each_other_are_one_replicate() -> None:
    np.testing.assert_array_equal(average_of_learners(np.array([[1, 2], [3, 6]])), [2.0, 4.0])
    with pytest.raises(UserError, match="a replicate occurs twice"):
        Sample("pair", np.array([1.0, 3.0]), ("run 1", "run 1"))


@pytest.mark.parametrize(
    ("values", "times", "why"),
    [
        (np.ones((2, 3)), [1, 2], "3 values a replicate, 2 times"),
        (np.ones((2, 2)), [2, 1], "do not ascend"),
        (np.ones((3, 2)), [1, 2], "for 2 replicates"),
        (np.array([[1, np.nan], [1, 1]]), [1, 2], "not finite"),
    ],
)
def test_curves_that_cannot_be_are_refused(values: np.ndarray, times: list[float], why: str) -> None:
    with pytest.raises(UserError, match=why):
        Curves("bad", np.array(times, float), values, (0, 1))
