"""What the columns of the tables mean, and their units: for the Parquet files and docs/tables.md."""

from __future__ import annotations

import json
from collections.abc import Iterable

_SUFFIXES = {
    "_steps_per_s": "motor steps/s",
    "_t_ns": "ns of the run's time",
    "_t_s": "s of the run's time",
    "_rad": "rad",
    "_m": "m",
    "_hz": "Hz",
    "_s": "s",
    "_v": "V",
}
"""The units that names end in, the longest first."""
_UNITS = {"t_s": "s of the run's time"} | dict.fromkeys(
    ("reward", "q_value", "q_change", "ratio", "confidences"), "none"
)

MEANINGS = {
    "log": "the file; the first, if several servers recorded the trial",
    "seed": "of the run",
    "trial": "of the run, from 0",
    "condition": "the robot's, as the experiment file names it; empty for what is no robot",
    "robot": "whom the message is from or about: a robot's id, or tracker, server, run",
    "epoch": "counts the sender's starts",
    "sequence": "counts the sender's messages under this key from 1",
    "t_s": "when the message was sent",
    "publish_t_ns": "when the message was sent",
    "receive_t_ns": "when the recorder had it",
    "number": "counts a trial's moves from 1",
    "track": "counts journeys from start to goal from 1",
    "state": "the cell, counted row by row from 0 in the north-west",
    "column": "of the state, from 0 in the west",
    "row": "of the state, from 0 in the north",
    "action": "the move: E, SE, S, SW, W, NW, N or NE",
    "next_state": "the cell entered; the same one if the move was blocked",
    "next_column": "of the next state",
    "next_row": "of the next state",
    "reward": "of the transition (eq. 7)",
    "duration_s": "of the move (eq. 7)",
    "q_value": "Q(state, action) after the update",
    "q_change": "of Q by the update, or over a replay",
    "blocked": "a wall: decided, not driven",
    "path": "the number of a remembered path, from 1, as in the pictures; 0 for none",
    "move": "how many moves the robot had made",
    "length": "of the greedy path, in moves; equals cap if it does not arrive",
    "cap": "as what a path that does not arrive counts",
    "moves": "the moves, by compass",
    "source": "given, or camera",
    "visit": "counts a trial's visits from 1; 0 for none",
    "outcome": "of a replay: completed, rejected, blocked or goal",
    "ratio": "R of the path afterwards (eq. 2 to 4)",
    "started_move": "the number of the replay's first move",
    "level": "INFO, WARNING or ERROR",
    "name": "of the event",
    "text": "of the event, for a person",
    "kind": "RUN, PAUSE, STOP or WATCH",
    "reason": "why; empty if there is nothing to say",
    "x_m": "to the east of the arena's south-west corner",
    "y_m": "to the north of the arena's south-west corner",
    "theta_rad": "heading, counter-clockwise from east",
    "captured_t_ns": "when it was seen",
    "phase": "of the run, or of a visit",
    "experiment": "the run's name",
    "run_id": "new with every run; empty in a simulation's lockstep",
    "identity": "fingerprint of experiment, seed, trial and message types; empty in a simulation's lockstep",
    "activity": "what the robot is at",
    "tracks": "journeys from start to goal, so far",
    "pose_age_s": "since the newest pose was captured",
    "bad_messages": "that could not be decoded, so far",
    "profile": "of the imitation: best or paper",
    "frames": "that the observer looked at",
    "confidences": "chi-square gap of each copied move",
    "window": "those of the copied moves that were remembered, by compass",
    "place": "in the observation, from 0",
    "frame_hash": "BLAKE2b of the frame's bytes, 8 bytes",
    "range_m": "from the camera; 0 if the demonstrator was not seen",
    "bearing_rad": "from the camera's axis",
    "not_seen": "why the demonstrator was not seen",
    "turn_rad": "from the segment before",
    "length_m": "of the segment",
    "heading_rad": "of the segment, counter-clockwise from east",
    "began_t_ns": "when it began",
    "ended_t_ns": "when it ended",
    "began_t_s": "when the first move was chosen",
    "ended_t_s": "when the last move ended",
    "demonstrator": "whom the observer watched",
    "true_moves": "what the demonstrator really did meanwhile, by compass",
    "copied_moves": "what was perceived, by compass",
    "edit_distance": "between the copied and the true moves",
    "left_steps_per_s": "speed sent to the left wheel",
    "right_steps_per_s": "speed sent to the right wheel",
    "wall_contacts": "touches of a wall, so far",
    "first_move": "its number",
    "blocked_moves": "how many were blocked",
    "replayed_moves": "how many belonged to a path that was replayed",
    "moving_s": "duration of all moves",
    "arrived": "whether it ended in the goal",
    "ready_t_s": "when the observer stood ready to be carried",
    "watching_t_s": "when it stood in its place and watched",
    "done_t_s": "when it was done",
    "known_from": "how many moves the robot had made when it remembered the path",
    "known_for": "how many it has made since",
    "replays": "how often the path was replayed",
    "real": "what the demonstrator really did, by compass; null if not known",
    "copied": "what was perceived, by compass; null if not known",
    "error": "the kind of the copying error; null if not known",
    "really_made": "whether the demonstrator made the remembered moves, whatever else was miscopied",
    "key": "of the messages",
    "delivery": "every, newest or bulk (docs/keys.md)",
    "restart": "counts the key's epochs from 0",
    "messages": "how many there are",
    "declared_hz": "rate by the key table; null for what comes as it happens",
    "seen_hz": "mean rate in the log",
    "longest_silence_s": "between two messages",
    "first_sequence": "above 1: what was sent before the recorder heard the sender",
    "last_sequence": "the last number seen",
    "sent": "the last number by the sender's own closing account; null if it gave none",
    "missing": "numbers from 1 to the last, or to `sent`, that were not seen",
    "gaps": "stretches of them",
    "duplicates": "numbers seen again",
    "out_of_order": "messages that came after one with a higher number",
    "rejected": "messages that could not be decoded",
    "received_t_ns": "the run's time at which it reached the tracker bridge",
    "source_t_ns": "the time of capture by the tracking system's own clock",
    "residual_m": "how far the markers were from where they should be",
    "quality": "the share of the robot's markers that were seen",
    "battery_v": "0 if the robot does not say",
    "proximity": "infra-red echoes ps0 to ps7, 0 to 4095: 120 is a wall at 5 cm",
    "reading_age_s": "since the last good answer over the robot's link",
    "failed_exchanges": "exchanges with the robot without a good answer so far",
    "refused_readings": "step counters that the wheels cannot have made",
    "refused_commands": "commands that came after their deadline",
    "paused": "whether a person ordered the robot to pause",
    "estopped": "whether an emergency stop is latched in the robot",
    "readable": "whether the messages' type is known here",
}
"""Of a column of this name in any table."""
_IN_TABLE = {
    ("health", "log"): "the file",
    ("replays", "moves"): "how many moves were replayed",
    ("statuses", "moves"): "how many moves the robot has made",
    ("journeys", "moves"): "how many moves it took",
    ("commands", "x_m"): "where the robot believes to be, to the east",
    ("commands", "y_m"): "where the robot believes to be, to the north",
    ("commands", "theta_rad"): "the heading that the robot believes to have",
    ("truths", "x_m"): "where the robot really is, to the east",
    ("truths", "y_m"): "where the robot really is, to the north",
}


def meaning_of(table: str, column: str) -> str:
    """In words; KeyError for a column that nobody has described."""
    return _IN_TABLE.get((table, column)) or MEANINGS[column]


def unit_of(column: str) -> str:
    """By the end of its name; empty for counts, numbers of things, and texts."""
    if column in _UNITS:
        return _UNITS[column]
    return next((unit for suffix, unit in _SUFFIXES.items() if column.endswith(suffix)), "")


def parquet_metadata(columns: Iterable[str]) -> dict[str, str]:
    """`units`: a JSON object of column -> unit, for the columns that have one."""
    return {"units": json.dumps({column: unit for column in columns if (unit := unit_of(column))})}
