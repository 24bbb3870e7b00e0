"""What a robot is carrying out at a moment: a move, and the path that the move belongs to."""

from __future__ import annotations

from typing import Any

from swarm.console.robot_history import RobotHistory, newest, place_at


def move_under_way(robot: RobotHistory, made: int, t_s: float) -> list[int] | None:
    """The cell and the action of the move that follows so many; known once the robot has told of it."""
    moves = robot.learning.moves
    if made < len(moves) and moves[made].t_s - moves[made].duration_s <= t_s:
        return [moves[made].state, moves[made].action]
    return None


def path_under_way(robot: RobotHistory, made: int, t_s: float) -> dict[str, Any] | None:
    """The path that is being enacted: its number, moves, first cell, and how many of its moves are made."""
    learning = robot.learning
    place = made if move_under_way(robot, made, t_s) else made - 1
    if place < 0 or not learning.moves[place].path or (place < made and _has_ended(robot, place, t_s)):
        return None
    number, first = learning.moves[place].path, _first_of_replay(robot, place)
    path = next((path for path in learning.paths if path.number == number), None)
    return {
        "number": number,
        "moves": list(path.moves) if path else [],
        "from": learning.moves[first].state,
        "done": made - first,
    }


def _has_ended(robot: RobotHistory, place: int, t_s: float) -> bool:
    """Whether the replay that a move belongs to was over by a time."""
    learning = robot.learning
    move = learning.moves[place]
    ended = learning.replays[: place_at(learning.replays, t_s)][-2:]
    return any(
        each.path == move.path and each.started_move <= move.number < each.started_move + each.moves
        for each in ended
    )


def _first_of_replay(robot: RobotHistory, place: int) -> int:
    """The place of the first move of the replay that a move belongs to.

    Two of one path may follow each other: the earlier one has ended with a `Replay`, or by a visit.
    """
    learning = robot.learning
    move = learning.moves[place]
    before_s = learning.moves[place - 1].t_s if place else 0.0
    ended, visit = newest(learning.replays, before_s), newest(robot.visits, before_s)
    begins = ended.started_move + ended.moves if ended else 1
    after_visit = learning.made(visit.t_s) if visit else 0
    first = place
    while first > after_visit:
        earlier = learning.moves[first - 1]
        if earlier.path != move.path or earlier.number < begins:
            break
        first -= 1
    return first
