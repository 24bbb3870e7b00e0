"""Tests of significance and effect sizes against scipy, published data and their levels."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from swarm.statistics.effect_size import d_z_interval, paired_effect_size
from swarm.statistics.paired_tests import (
    Window,
    max_t_test,
    paired_t_test,
    pointwise_t_test,
    significant_windows,
)
from swarm.statistics.samples import Curves, PairingError, Sample, paired_differences

# Student's own sleep data (Biometrika 6, 1908): hours gained with two drugs by ten patients;
# t = -4.0621, p = 0.002833.
DRUG_1 = np.array([0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0])
DRUG_2 = np.array([1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4])
PATIENTS = tuple(range(10))


def curves(name: str, values: np.ndarray) -> Curves:
    return Curves(name, np.arange(1.0, values.shape[1] + 1), values, tuple(range(len(values))))


def noise(seed: int, replicates: int = 20, points: int = 40) -> np.ndarray:
    """Correlated over time, as learning curves are."""
    white = np.random.default_rng(seed).normal(size=(replicates, points + 4))
    return np.asarray(sum(white[:, lag : lag + points] for lag in range(5)))


def test_the_paired_t_test_of_students_sleep_data() -> None:
    test = paired_t_test(Sample("1", DRUG_1, PATIENTS), Sample("2", DRUG_2, PATIENTS))
    assert test.t == pytest.approx(-4.0621, abs=5e-5)
    assert test.p == pytest.approx(0.002833, abs=5e-7)
    assert test.degrees_of_freedom == 9


def test_pairs_are_found_by_their_seed_not_by_their_place() -> None:
    shuffled = Sample("2", DRUG_2[::-1].copy(), PATIENTS[::-1])
    difference = paired_differences(Sample("1", DRUG_1, PATIENTS), shuffled)
    np.testing.assert_array_equal(difference.values, DRUG_1 - DRUG_2)


def test_the_pointwise_test_is_scipys_at_every_point() -> None:
    first, second = noise(1), noise(2)
    test = pointwise_t_test(curves("a", first), curves("b", second))
    expected = stats.ttest_rel(first, second)
    np.testing.assert_allclose(test.t, expected.statistic)
    np.testing.assert_allclose(test.p, expected.pvalue)


def test_points_without_variance_neither_stop_nor_fool_the_pointwise_test() -> None:
    first, second = noise(1), noise(2)
    first[:, 0], first[:, 1] = second[:, 0], second[:, 1] + 0.5
    test = pointwise_t_test(curves("a", first), curves("b", second))
    assert (test.t[0], test.p[0]) == (0, 1)
    assert test.t[1] > 1e6 or np.isinf(test.t[1])
    assert test.p[1] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("second", "why"),
    [
        (
            Sample("b", DRUG_2, tuple(range(1, 11))),
            "2 replicates .* are in only one of them; run both with",
        ),
        (Sample("b", DRUG_2[:9], PATIENTS[:9]), "1 replicates .* are in only one"),
        (Sample("b", DRUG_1, PATIENTS), r"every pair differs by 0 \(zero variance\)"),
    ],
)
def test_wrong_pairings_are_refused_with_a_reason(second: Sample, why: str) -> None:
    first = Sample("a", DRUG_1, PATIENTS)
    with pytest.raises(PairingError, match=why):
        paired_t_test(first, second)
    with pytest.raises(PairingError, match=why):
        paired_effect_size(first, second)


def test_one_pair_is_refused() -> None:
    with pytest.raises(PairingError, match="1 pair; at least 2 are needed"):
        paired_t_test(Sample("a", DRUG_1[:1], (0,)), Sample("b", DRUG_2[:1], (0,)))


def test_curves_that_never_differ_are_refused() -> None:
    same = curves("a", noise(1))
    for test in (pointwise_t_test, lambda a, b: max_t_test(a, b, np.random.default_rng(0))):
        with pytest.raises(PairingError, match="zero variance"):
            test(same, same)


def test_curves_of_other_times_are_refused() -> None:
    first, second = curves("a", noise(1)), curves("b", noise(2))
    with pytest.raises(PairingError, match="not measured at the same times"):
        pointwise_t_test(
            first.every(2), Curves("b", second.every(2).times + 1, second.every(2).values, second.replicates)
        )


def test_the_exact_sign_flip_test_is_scipys() -> None:
    difference = curves("d", (DRUG_1 - DRUG_2)[:, None])
    zero = curves("0", np.zeros((10, 1)))
    test = max_t_test(difference, zero, np.random.default_rng(0))
    expected = stats.permutation_test(
        (DRUG_1 - DRUG_2,), np.mean, permutation_type="samples", n_resamples=np.inf, alternative="two-sided"
    )
    assert test.exact
    assert test.permutations == 2**9
    assert test.smallest_p == pytest.approx(float(expected.pvalue))
    assert test.direction[0] == -1


def test_drawn_tosses_agree_with_all_tosses() -> None:
    first, second = curves("a", noise(3, 12) + 1.5), curves("b", noise(4, 12))
    exact = max_t_test(first, second, np.random.default_rng(0), permutations=2048)
    drawn = max_t_test(first, second, np.random.default_rng(0), permutations=2047)
    assert exact.exact
    assert not drawn.exact
    np.testing.assert_allclose(drawn.p, exact.p, atol=0.03)


def test_the_ratio_that_is_compared_stands_for_t() -> None:
    first, second = noise(5, 10, 6), noise(6, 10, 6)
    test = max_t_test(curves("a", first), curves("b", second), np.random.default_rng(0))
    t = np.abs(stats.ttest_rel(first, second).statistic)
    signs = 1 - 2 * (np.arange(512)[:, None] >> np.arange(10) & 1)
    flipped = signs[:, :, None] * (first - second)
    largest = np.abs(stats.ttest_1samp(flipped, 0, axis=1).statistic).max(axis=1)
    np.testing.assert_allclose(test.p, (largest[:, None] >= t * (1 - 1e-9)).mean(axis=0))


def test_the_honest_test_holds_its_level_over_the_whole_curve_and_the_papers_does_not() -> None:
    trials, family_wise, paper = 300, 0, 0
    for trial in range(trials):
        first, second = curves("a", noise(1000 + trial)), curves("b", noise(9000 + trial))
        family_wise += max_t_test(first, second, np.random.default_rng(trial), 1000).smallest_p <= 0.05
        paper += bool(np.any(pointwise_t_test(first, second).p <= 0.05))
    assert stats.binomtest(family_wise, trials, 0.05).pvalue > 0.01
    assert paper / trials > 0.3


def test_the_honest_test_finds_where_the_difference_is() -> None:
    second = noise(8)
    first = noise(7)
    first[:, 15:25] += 10
    test = max_t_test(curves("a", first), curves("b", second), np.random.default_rng(1))
    found = significant_windows((test.p <= 0.05) & (test.direction > 0), np.arange(40.0))
    assert found == [Window(15.0, 24.0)]


def test_the_same_generator_gives_the_same_p_values() -> None:
    first, second = curves("a", noise(3)), curves("b", noise(4))
    once, again = (max_t_test(first, second, np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(once.p, again.p)


def test_a_constant_difference_is_no_special_case_for_sign_flips() -> None:
    first, second = noise(3), noise(3)
    first[:, :20] += 4.0
    second[:, 20:] += noise(4)[:, 20:]
    test = max_t_test(curves("a", first), curves("b", second), np.random.default_rng(5), 1999)
    assert np.all(test.p[:20] == pytest.approx(1 / 2000))


def test_cohens_d_z_of_students_sleep_data() -> None:
    effect = paired_effect_size(Sample("1", DRUG_1, PATIENTS), Sample("2", DRUG_2, PATIENTS))
    assert effect.mean_difference == pytest.approx(-1.58)
    assert list(effect.mean_interval) == pytest.approx([-2.4598858, -0.7001142])  # R's t.test
    assert effect.d_z == pytest.approx(-1.2845585, abs=1e-6)
    assert effect.pairs == 10


@pytest.mark.parametrize(("d_z", "pairs"), [(-1.28, 10), (0.0, 20), (0.4, 100), (3.5, 6), (8.0, 100)])
def test_the_interval_of_d_z_inverts_the_noncentral_t(d_z: float, pairs: int) -> None:
    low, high = d_z_interval(d_z, pairs)
    root = np.sqrt(pairs)
    assert stats.nct.sf(d_z * root, pairs - 1, low * root) == pytest.approx(0.025, abs=1e-5)
    assert stats.nct.cdf(d_z * root, pairs - 1, high * root) == pytest.approx(0.025, abs=1e-5)
    assert low < d_z < high


def test_the_interval_of_d_z_covers_with_its_level() -> None:
    rng, trials = np.random.default_rng(3), 400
    covered = 0
    for _ in range(trials):
        sample = rng.normal(0.5, 1, size=25)
        low, high = d_z_interval(float(sample.mean() / sample.std(ddof=1)), 25)
        covered += low <= 0.5 <= high
    assert stats.binomtest(covered, trials, 0.95).pvalue > 0.01


@pytest.mark.parametrize(
    ("bridge", "shortest", "expected"),
    [
        (0, 1, [Window(1, 2), Window(4, 4), Window(7, 9)]),
        (1, 1, [Window(1, 4), Window(7, 9)]),
        (2, 1, [Window(1, 9)]),
        (0, 2, [Window(1, 2), Window(7, 9)]),
    ],
)
def test_windows_of_significant_points(bridge: int, shortest: int, expected: list[Window]) -> None:
    significant = np.isin(np.arange(11), [1, 2, 4, 7, 8, 9])
    assert significant_windows(significant, np.arange(11.0), bridge, shortest) == expected
    assert significant_windows(significant & False, np.arange(11.0), bridge, shortest) == []
