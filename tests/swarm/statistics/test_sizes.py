"""Sizes and equivalence, and the corrections for many claims, against scipy and published values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from swarm.statistics.corrections import benjamini_hochberg, holm
from swarm.statistics.samples import PairingError, Sample
from swarm.statistics.sizes import above, below, equivalent


def sample(values: np.ndarray) -> Sample:
    return Sample("drawn", values, tuple(range(len(values))))


def test_above_is_scipys_one_sided_test() -> None:
    rng = np.random.default_rng(1)
    one, other = rng.normal(1.0, 2.0, 30), rng.normal(0.0, 2.0, 30)
    found = above(sample(one), sample(other), 0.5)
    expected = stats.ttest_1samp(one - other, 0.5, alternative="greater")
    assert found.p == pytest.approx(expected.pvalue)
    assert found.bound == pytest.approx(expected.confidence_interval(0.95).low)


def test_below_is_the_same_seen_from_the_other_side() -> None:
    rng = np.random.default_rng(2)
    one, other = sample(rng.normal(size=20)), sample(rng.normal(size=20))
    expected = stats.ttest_1samp(one.values - other.values, 1.0, alternative="less")
    found = below(one, other, 1.0)
    assert found.p == pytest.approx(expected.pvalue)
    assert found.bound == pytest.approx(expected.confidence_interval(0.95).high)


def test_few_pairs_cannot_be_called_the_same() -> None:
    rng = np.random.default_rng(3)
    many = equivalent(sample(rng.normal(size=400)), sample(rng.normal(size=400)), 0.3)
    few = equivalent(sample(rng.normal(size=8)), sample(rng.normal(size=8)), 0.3)
    assert many.p < 0.05 < few.p
    assert many.bound < 0.3 < few.bound


def test_what_differs_by_the_margin_is_called_the_same_in_5_percent() -> None:
    rng, same = np.random.default_rng(4), 0
    for _ in range(1000):
        differences = rng.normal(0.3, 1.0, 50)
        same += equivalent(sample(differences), sample(np.zeros(50)), 0.3).p <= 0.05
    assert 0.035 < same / 1000 < 0.065


def test_pairs_that_never_differ_cannot_be_tested() -> None:
    with pytest.raises(PairingError, match="zero variance"):
        above(sample(np.ones(5)), sample(np.ones(5)))


def test_holm_of_a_worked_example() -> None:
    np.testing.assert_allclose(holm(np.array([0.01, 0.04, 0.03, 0.005])), [0.03, 0.06, 0.06, 0.02])


def test_benjamini_and_hochberg_of_a_worked_example() -> None:
    found = benjamini_hochberg(np.array([0.01, 0.04, 0.03, 0.005]))
    np.testing.assert_allclose(found, [0.02, 0.04, 0.04, 0.02])
    assert len(benjamini_hochberg(np.array([]))) == 0
