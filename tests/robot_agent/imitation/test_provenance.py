"""Provenance: a copied path can be traced back to the frames that it comes from."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from swarm.geometry import Move
from swarm.messages import swarm_pb2 as pb
from swarm.messages.validation import decode
from tests.support.staged_visit import MOVES, VISIT, demonstration, staged


@pytest.fixture(scope="module")
def observation() -> pb.Observation:
    """Of a demonstration of five moves, seen with a rendered camera, as it goes over the wire."""
    return decode(pb.Observation, staged(demonstration()).run().observation.SerializeToString())


def test_it_says_which_visit_and_how(observation: pb.Observation) -> None:
    assert (observation.visit, observation.profile, observation.frames) == (VISIT, "best", 100)
    assert observation.reason == ""


def test_every_frame_is_there_with_its_hash_and_what_it_showed(observation: pb.Observation) -> None:
    assert len(observation.looks) == observation.frames
    assert len({look.frame_hash for look in observation.looks}) == len(observation.looks)
    for look in observation.looks:
        assert bool(look.not_seen) != (look.range_m > 0)
    times = [look.captured_t_ns for look in observation.looks]
    assert {later - earlier for earlier, later in pairwise(times)} == {200_000_000}


def test_a_place_follows_from_range_and_bearing(observation: pb.Observation) -> None:
    """Seen from the camera at the observer's place: the distance agrees with the range."""
    seen = [look for look in observation.looks if look.range_m > 0]
    for look in seen:
        from_axis_m = math.hypot(look.x_m - 1.25, look.y_m + 0.05)
        assert from_axis_m == pytest.approx(look.range_m + 0.03, abs=0.015)


def test_segments_smoothed_positions_and_moves_agree(observation: pb.Observation) -> None:
    assert [Move(move) for move in observation.moves] == list(MOVES)
    assert len(observation.confidences) == len(observation.moves)
    assert min(observation.confidences) > 0
    driven_m = sum(segment.length_m for segment in observation.segments)
    diagonals = sum(move % 2 for move in MOVES)
    assert driven_m == pytest.approx(0.12 * (len(MOVES) - diagonals + math.sqrt(2) * diagonals), abs=0.03)
    times = [position.captured_t_ns for position in observation.smoothed]
    assert times == sorted(times)
    began, ended = observation.segments[0].began_t_ns, observation.segments[-1].ended_t_ns
    assert times[0] <= began < ended <= times[-1]
