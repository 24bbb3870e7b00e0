"""What only a person's hand can do: asked for until it is done, and seen to be done by the robot's pose."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb

AT_PLACE_M = 0.05
"""What a robot itself asks of a hand before it begins to watch."""


@dataclass(frozen=True)
class Asked:
    """One prompt that nobody has done yet."""

    number: int
    robot: str
    place: Pose
    text: str
    since_ns: int | None = None


class Prompts:
    """The prompts of a trial that are not done; of each robot only the last, which outdates those before."""

    def __init__(self) -> None:
        self._pending: dict[str, Asked] = {}
        self._number = 0
        self._t_ns: int | None = None

    def ask(self, robot: str, place: Pose, text: str) -> int:
        """Have a robot put to a place; the prompt's number."""
        self._number += 1
        self._pending[robot] = Asked(self._number, robot, place, text, self._t_ns)
        return self._number

    def numbered(self, number: int) -> Asked | None:
        """A prompt that is not done; None if there is none of this number."""
        return next((asked for asked in self._pending.values() if asked.number == number), None)

    def close(self, asked: Asked) -> None:
        """It is done."""
        self._pending.pop(asked.robot, None)

    def look(self, poses: dict[str, Pose], t_ns: int) -> list[Asked]:
        """Close the prompts whose robots stand where they are wanted by their own poses, and return them."""
        self._t_ns = t_ns
        done = [asked for asked in self._pending.values() if is_done(asked, poses.get(asked.robot))]
        for asked in done:
            self.close(asked)
        return done

    def messages(self) -> Iterable[pb.Prompt]:
        """For whoever asks how the run goes."""
        for asked in sorted(self._pending.values(), key=lambda asked: asked.number):
            waits_ns = (self._t_ns or 0) - (asked.since_ns or self._t_ns or 0)
            place = asked.place
            yield pb.Prompt(
                number=asked.number,
                robot=asked.robot,
                text=asked.text,
                x_m=place.x_m,
                y_m=place.y_m,
                theta_rad=place.theta_rad,
                waits_s=waits_ns / NS_PER_S,
            )


def is_done(asked: Asked, pose: Pose | None) -> bool:
    """Whether a robot's pose shows that it stands where it is wanted."""
    return pose is not None and asked.place.distance_m(pose) <= AT_PLACE_M
