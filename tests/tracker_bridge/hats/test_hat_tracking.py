"""Hats named in clouds of markers without names, with all that happens in a laboratory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import pytest

from tests.benchmarks.hats import run
from tracker_bridge.emulators.marker_clouds import CloudFaults
from tracker_bridge.hats.design import design_hats
from tracker_bridge.hats.hat_events import HatEvent
from tracker_bridge.hats.hat_tracking import HatTracker, TrackedHat
from tracker_bridge.hats.patterns import Hat, PinGrid

Points = npt.NDArray[np.complex128]

CLOUD_NS = 10_000_000
SECOND = 100
"""Clouds."""


@pytest.fixture(name="hats", scope="module")
def _hats() -> list[Hat]:
    return design_hats(PinGrid(), 30)


@dataclass
class Laboratory:
    """Robots that stand, with hats, and a tracker with 0.5 mm of noise."""

    hats: list[Hat]
    places: dict[str, complex]
    hidden: dict[str, list[int]] = field(default_factory=dict)
    strays: list[complex] = field(default_factory=list)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))
    clouds: int = 0

    def __post_init__(self) -> None:
        self.tracker = HatTracker(self.hats)

    def wait(self, clouds: int) -> tuple[list[TrackedHat], list[HatEvent]]:
        """Let clouds pass: what the last one showed, and what was told meanwhile."""
        told: list[HatEvent] = []
        for _ in range(clouds):
            self.clouds += 1
            tracked, events = self.tracker.update(self._cloud(), self.clouds * CLOUD_NS)
            told += events
        return tracked, told

    def _cloud(self) -> Points:
        pins = {hat.name: hat.pins for hat in self.hats}
        points = [
            place + pin
            for name, place in self.places.items()
            for number, pin in enumerate(pins[name])
            if number not in self.hidden.get(name, [])
        ] + self.strays
        noise = self.rng.normal(0, 0.0005, (len(points), 2)) @ np.array([1, 1j])
        return self.rng.permutation(np.array(points, dtype=np.complex128) + noise)


def names(tracked: list[TrackedHat]) -> dict[str, complex]:
    return {hat.name: complex(round(hat.pose.x_m, 2), round(hat.pose.y_m, 2)) for hat in tracked}


def kinds(events: list[HatEvent]) -> list[str]:
    return [event.kind for event in events if event.kind != "named"]


def test_hats_are_named_by_their_pins_alone(hats: list[Hat]) -> None:
    places = {"3": 1.0 + 1j, "17": 1.08 + 1j, "30": 2.0 + 0.5j}
    tracked, events = Laboratory(hats, places).wait(10)
    assert names(tracked) == places
    assert [hat.pose.theta_rad for hat in tracked] == pytest.approx([0.0] * 3, abs=0.05)
    assert sorted(event.hats[0] for event in events) == ["17", "3", "30"]


def test_a_robot_keeps_its_name_while_half_its_pins_are_hidden(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"5": 1.0 + 1j})
    laboratory.wait(10)
    laboratory.hidden["5"] = [0, 2]
    tracked, events = laboratory.wait(20)
    assert names(tracked) == {"5": 1.0 + 1j}
    assert tracked[0].pins_seen == 2
    assert kinds(events) == []


def test_two_robots_that_were_exchanged_are_named_as_a_swap(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"1": 1.0 + 1j, "2": 2.0 + 1j})
    laboratory.wait(10)
    laboratory.places = {"1": 2.0 + 1j, "2": 1.0 + 1j}
    told, wrong = [], 0
    for _ in range(60):
        tracked, events = laboratory.wait(1)
        told += events
        wrong += any(laboratory.places[name] != place for name, place in names(tracked).items())
    assert names(tracked) == laboratory.places
    assert wrong == 0, "no pose is told under the other's name"
    (swap,) = [event for event in told if event.kind == "swap"]
    assert sorted(swap.hats) == ["1", "2"]


def test_a_pin_that_fell_off_is_named(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"7": 1.0 + 1j, "8": 2.0 + 1j})
    laboratory.wait(10)
    laboratory.hidden["7"] = [2]
    tracked, events = laboratory.wait(3 * SECOND)
    assert names(tracked) == laboratory.places
    assert [(event.kind, event.text) for event in events] == [
        ("missing pin", "hat 7: pin 3 has not been seen for 1 s")
    ]


def test_a_hat_that_lacks_a_pin_from_the_start_is_named_if_no_other_shares_the_rest(hats: list[Hat]) -> None:
    """Hat 2 without its first pin is like no other; hat 4 without its second is hat 6 without one."""
    laboratory = Laboratory(hats[:10], {"2": 1.0 + 1j, "4": 2.0 + 1j}, hidden={"2": [0], "4": [1]})
    tracked, events = laboratory.wait(3 * SECOND)
    assert names(tracked) == {"2": 1.0 + 1j}
    assert sorted(kinds(events)) == ["ambiguous", "missing pin"]


def test_who_is_seen_elsewhere_is_not_a_hat_that_lacks_a_pin(hats: list[Hat]) -> None:
    places = {hat.name: complex(round(0.2 * (number + 1), 1), 1) for number, hat in enumerate(hats[:10])}
    laboratory = Laboratory(hats[:10], places, hidden={"4": [1]})
    tracked, _ = laboratory.wait(3 * SECOND)
    assert names(tracked) == places


def test_a_stray_reflection_is_named_and_no_robot(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"7": 1.0 + 1j}, strays=[1.5 + 1.5j])
    tracked, events = laboratory.wait(2 * SECOND)
    assert names(tracked) == laboratory.places
    assert kinds(events) == ["stray reflection"]
    assert "(1.50" in next(event.text for event in events if event.kind == "stray reflection")


def test_a_robot_that_is_taken_away_is_lost_and_found_elsewhere(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"9": 1.0 + 1j})
    laboratory.wait(10)
    laboratory.places = {}
    tracked, events = laboratory.wait(SECOND)
    assert (tracked, kinds(events)) == ([], ["lost"])
    laboratory.places = {"9": 2.0 + 2j}
    tracked, events = laboratory.wait(20)
    assert names(tracked) == {"9": 2.0 + 2j}
    assert kinds(events) == []


def test_a_second_hat_of_the_same_pattern_is_told(hats: list[Hat]) -> None:
    laboratory = Laboratory(hats, {"6": 1.0 + 1j})
    laboratory.wait(10)
    laboratory.strays = [2.0 + 2j + pin for pin in hats[5].pins]
    tracked, events = laboratory.wait(SECOND)
    assert names(tracked) == {"6": 1.0 + 1j}
    assert kinds(events).count("twice") == 1


def test_an_empty_cloud_is_no_trouble(hats: list[Hat]) -> None:
    tracker = HatTracker(hats)
    assert tracker.update(np.empty(0, dtype=np.complex128), CLOUD_NS) == ([], [])


@pytest.mark.parametrize("frames", [600, pytest.param(60_000, marks=pytest.mark.long)])
def test_fifty_hats_in_one_cloud_are_never_taken_for_each_other(frames: int) -> None:
    figures = run(design_hats(PinGrid(), 50), frames, CloudFaults(), seed=2)
    assert figures["wrong"] == 0
    assert figures["identified"] >= 0.98 if frames < 1000 else figures["identified"] >= 0.99
