"""A small experiment with cameras: two learners copy each other, a third copies an expert."""

from __future__ import annotations

PLACES = {"expert": (0.1, 0.1), "pupil": (1.5, 0.1), "left": (2.9, 0.1), "right": (4.3, 0.1)}
WATCHES = {"pupil": "expert", "left": "right", "right": "left"}


def camera_experiment_text(moves: int = 20, names: tuple[str, ...] = tuple(PLACES), seed: int = 1) -> str:
    """An experiment file with one robot a process; visits are short, so that a run is small."""
    lines = ["[run]", 'name = "cameras"', f"moves = {moves}", f"seed = {seed}"]
    lines += ["[arena]", "width_m = 5.6", "[visits]", "duration_s = 20.0", "every_tracks = 1"]
    for name in names:
        lines += ["[[robot]]", f'id = "{name}"', f"south_west_m = {list(PLACES[name])}"]
        lines += [f'role = "{"expert" if name == "expert" else "learner"}"']
        lines += [f'watches = "{WATCHES[name]}"'] if WATCHES.get(name) in names else []
    return "\n".join(lines) + "\n"
