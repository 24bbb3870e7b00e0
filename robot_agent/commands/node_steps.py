"""Runs what a tool does with a robot, tick by tick, on a node of the swarm."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import suppress
from typing import TypeVar

from swarm.errors import UserError
from swarm.runtime.node import Node

T = TypeVar("T")


class _StepsEndedError(Exception):
    """The steps have returned: what ends the ticks of a node."""


def run_steps(node: Node, steps: Generator[None, int, T]) -> T:
    """Send the time of every tick into the steps until they return. UserError if the run ends before."""
    next(steps)
    results: list[T] = []

    def step(t_ns: int) -> None:
        try:
            steps.send(t_ns)
        except StopIteration as ended:
            results.append(ended.value)
            raise _StepsEndedError from ended

    with suppress(_StepsEndedError):
        node.run(step)
    if not results:
        raise UserError("the run ended before the robot was done: start it again and repeat this")
    return results[0]
