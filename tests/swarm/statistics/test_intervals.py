"""Averages, areas and bands against scipy, published values and their own promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from swarm.errors import UserError
from swarm.statistics.averages import average, weighted_iqm, weighted_mean
from swarm.statistics.intervals import (
    Ends,
    ends_of,
    interval,
    pointwise_t_band,
    sample_interval,
    simultaneous_band,
)
from swarm.statistics.samples import Curves, Sample, Scale, average_of_learners, mean_level


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


SCALE = Scale(9, 100)


def test_a_band_stays_inside_its_scale_and_holds_the_mean() -> None:
    values = np.random.default_rng(13).choice([9.0, 10.0, 100.0], size=(6, 50))
    ends = Ends(SCALE, np.full(50, 100.0))
    for band in (pointwise_t_band(values, ends), simultaneous_band(values, np.random.default_rng(1), ends)):
        assert np.all((band.low >= 9) & (band.low <= band.centre))
        assert np.all((band.high <= 100) & (band.high >= band.centre))


def test_far_from_the_ends_the_scale_changes_little() -> None:
    values = np.random.default_rng(14).normal(50, 10, size=(100, 1))
    free, bounded = pointwise_t_band(values), sample_interval(values, Scale(0, 100))
    np.testing.assert_allclose(bounded.errors, free.errors, rtol=0.1)


def test_where_all_are_capped_the_interval_still_has_a_width() -> None:
    band = sample_interval(np.full((10, 1), 100.0), SCALE)
    assert band.high[0] == 100
    assert 20 < band.low[0] < 97


def test_a_replicate_may_still_be_where_the_slowest_was_at_half_the_time() -> None:
    times, values = np.arange(1.0, 9), np.array([[100.0] * 3 + [9] * 5, [100.0] * 2 + [9] * 6])
    ends = ends_of(Curves("two", times, values, (0, 1), SCALE))
    assert ends is not None
    assert ends.latest.tolist() == [100, 100, 100, 100, 100, 100, 100, 9]


def learning(trials: int, seed: int) -> Curves:
    """Runs that come down from 100 to 9, each at its own time; a fifth of them late."""
    rng = np.random.default_rng(seed)
    times = np.arange(1.0, 41)
    arrival = rng.gamma(4, 3, size=trials) * np.where(rng.random(trials) < 0.2, 2, 1)
    since = np.clip(times - arrival[:, None], 0, None)
    values = np.where(times < arrival[:, None], 100.0, 9 + 40 / (1 + since))
    return Curves("learning", times, np.clip(values, 9, 100), tuple(range(trials)), SCALE)


@pytest.mark.parametrize("trials", [4, 10, 30])
def test_bands_of_capped_learners_hold_the_truth(trials: int) -> None:
    truth = learning(20_000, 1).values.mean(axis=0)
    held, whole, samples = [], [], 150
    for sample in range(samples):
        curves = learning(trials, 2 + sample)
        band = interval(curves)
        wide = simultaneous_band(curves.values, np.random.default_rng(sample), ends_of(curves), resamples=300)
        assert band is not None
        held.append((band.low <= truth) & (truth <= band.high))
        whole.append(np.all((wide.low <= truth) & (truth <= wide.high)))
    assert np.mean(held) > 0.94
    assert np.mean(whole) > 0.9


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


def test_the_level_of_known_curves() -> None:
    curves = Curves("ramp", np.array([0.0, 1, 3]), np.array([[0.0, 1, 3], [2, 2, 2]]), (0, 1))
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
