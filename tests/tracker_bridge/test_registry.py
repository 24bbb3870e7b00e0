"""Tracking systems are found by their names."""

from __future__ import annotations

import pytest

from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from swarm.plugins import TRACKERS, plugins
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.backends.interface import Setup, TrackingSystem
from tracker_bridge.backends.registry import system_named


def test_every_entry_is_a_tracking_system() -> None:
    names = set(plugins(TRACKERS))
    assert {"sim", "vicon", "natnet", "replay", "motioncapture"} <= names
    assert all(isinstance(system_named(name), TrackingSystem) for name in names)


def test_an_unknown_name_is_answered_by_what_there_is() -> None:
    with pytest.raises(UserError, match=r"did you mean 'vicon'\? \(there is: .*natnet.*\)"):
        system_named("vicom")


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (TrackerSettings(backend="sim"), "only within a run"),
        (TrackerSettings(backend="replay"), "no file is given"),
        (TrackerSettings(backend="vicon", interface="192.0.2.1"), "cannot listen on 192.0.2.1:51001"),
        (TrackerSettings(backend="natnet", version="2.4"), "versions 2.5 to 4.1 are"),
        (TrackerSettings(backend="vicon", axes="x y"), "does not name three axes"),
    ],
)
def test_settings_that_cannot_work_are_named(settings: TrackerSettings, said: str) -> None:
    system = system_named(settings.backend)
    with pytest.raises(UserError, match=said), system.open(Setup(tracked_experiment(settings), None)):
        pass
