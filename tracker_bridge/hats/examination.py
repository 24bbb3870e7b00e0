"""Whether the hats of a set can be told apart."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from tracker_bridge.hats.design import LEAST_SPACING_M
from tracker_bridge.hats.patterns import Hat, difference_m, self_difference_m


@dataclass(frozen=True)
class Examination:
    """The least difference of the set and what is wrong with it, a sentence each."""

    least_difference_m: float
    findings: tuple[str, ...]


def examine(hats: list[Hat], tolerance_m: float) -> Examination:
    """Compare all hats with each other and with themselves turned; they should differ by the tolerance."""
    pins = np.array([hat.pins for hat in hats])
    between_m = difference_m(pins, pins)
    turned_m = self_difference_m(pins)
    findings = [_crowded(hat) for hat in hats if _closest_m(hat) < LEAST_SPACING_M - 1e-6]
    findings += [
        f"hat {hat.name} looks the same turned round (its pins then miss by {1e3 * apart_m:.1f} mm): "
        "its heading may be read wrong; move a pin"
        for hat, apart_m in zip(hats, turned_m, strict=True)
        if apart_m < tolerance_m
    ]
    findings += [
        f"hats {hats[one].name} and {hats[other].name} differ by {1e3 * between_m[one, other]:.1f} mm: "
        "move a pin of one of them"
        for one, other in combinations(range(len(hats)), 2)
        if between_m[one, other] < tolerance_m
    ]
    differences = between_m[~np.eye(len(hats), dtype=np.bool_)]
    return Examination(float(np.min(np.concatenate([differences, turned_m]))), tuple(findings))


def _closest_m(hat: Hat) -> float:
    return min(abs(one - other) for one, other in combinations(hat.pins, 2))


def _crowded(hat: Hat) -> str:
    return (
        f"hat {hat.name} has pins {1e3 * _closest_m(hat):.1f} mm apart: markers of 8 mm run together below "
        f"{1e3 * LEAST_SPACING_M:.0f} mm"
    )
