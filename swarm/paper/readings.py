"""The open points of section 2: what the paper leaves unsaid or says twice, each with its alternatives.

A reading is data: an option, where the paper leaves it open, what each alternative changes in a condition.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from swarm.errors import UserError, nearest
from swarm.gridworld.arena import OBSTACLE_100, OPEN_10
from swarm.gridworld.condition import Condition, CopyExperienced, CopyExpert, Precision
from swarm.learning.controller import QIncrease

Change = Callable[[Condition], Condition]


@dataclass(frozen=True)
class Option:
    """An open point; the first of its `alternatives` is the default, which changes nothing."""

    name: str
    place: str
    """Where the paper leaves it open, in its words."""
    alternatives: Mapping[str, Change]
    why: str
    """Why the default is what it is."""

    @property
    def default(self) -> str:
        return next(iter(self.alternatives))


def _same(condition: Condition) -> Condition:
    return condition


def _epsilon(arena: str, epsilon: float) -> Change:
    return lambda condition: (
        replace(condition, epsilon=epsilon) if condition.arena.name == arena else condition
    )


def _copies_at_once(condition: Condition) -> Condition:
    teacher = condition.teacher
    if not isinstance(teacher, CopyExpert | CopyExperienced):
        return condition
    return replace(condition, teacher=replace(teacher, copies_at_once=True))


def _imitating(change: Change) -> Change:
    """Of conditions without imitation nothing changes."""
    return lambda condition: change(condition) if condition.imitates else condition


def _increase(increase: QIncrease) -> Change:
    return _imitating(lambda condition: replace(condition, increase=increase))


OPTIONS = (
    Option(
        "first-copy",
        '2.3.2: "The second agent starts with an empty memory and once every 100 simulation runs, it copies '
        'a random consecutive portion"',
        {"after-100-runs": _same, "before-the-first-run": _copies_at_once},
        "A memory that a path is put into before the first run is not empty at the start.",
    ),
    Option(
        "epsilon-100",
        '2.1: "with a probability of ε, it chooses a random action" (no number; 100 x 100 arena)',
        {
            "0.5": _same,
            "0.4": _epsilon(OBSTACLE_100.name, 0.4),
            "0.6": _epsilon(OBSTACLE_100.name, 0.6),
        },
        "The times of figures 12, 15 and 16 are those of 0.5.",
    ),
    Option(
        "epsilon-10",
        '2.1: "with a probability of ε, it chooses a random action" (no number; 10 x 10 arena)',
        {"0.3": _same, "0.1": _epsilon(OPEN_10.name, 0.1), "0.5": _epsilon(OPEN_10.name, 0.5)},
        "Figures 3 to 9 hardly tell between them: 0.5 gives the same verdicts.",
    ),
    Option(
        "q-increase",
        '2.2: "the average Q value is recorded at the start of each imitation sequence and is compared to '
        'the average Q value when the imitated path is completed or abandoned"',
        {
            "change-asked-for": _same,
            "change-stored": _increase(QIncrease.STORED),
            "average-as-printed": _increase(QIncrease.AVERAGE),
        },
        "With the change that the rule asks for, R of SE ends at 0.7, as in figure 14; with those of the "
        "stored values, at 0.08.",
    ),
    Option(
        "precision",
        "(not said: the arithmetic of the stored Q values)",
        {"double": _same, "single": lambda condition: replace(condition, precision=Precision.SINGLE)},
        "What most programs use.",
    ),
    Option(
        "last-action",
        'algorithm 2: the path is closed before the check "if pathChosen > 0"; 2.3.1: "making the same check '
        'at each step"',
        {
            "as-printed": _same,
            "checked": _imitating(lambda condition: replace(condition, checks_last=True)),
        },
        "The listing is exact where the sentence sums up.",
    ),
)
"""In the order in which they are named."""


@dataclass(frozen=True)
class Readings:
    """One alternative of each option; those not `chosen` are the defaults."""

    chosen: Mapping[str, str] = field(default_factory=dict)

    def of(self, condition: Condition) -> Condition:
        """The condition so read; its name tells every choice that changes it."""
        for option in OPTIONS:
            word = self.chosen.get(option.name, option.default)
            changed = option.alternatives[word](condition)
            if changed != condition:
                condition = replace(changed, name=f"{condition.name}@{option.name}={word}")
        return condition

    @property
    def label(self) -> str:
        """What differs from the default."""
        return ", ".join(f"{name}={word}" for name, word in self.chosen.items()) or "default"


DEFAULT = Readings()


def parse_readings(words: list[str]) -> Readings:
    """Readings of words such as "epsilon-100=0.6"; UserError names what is wrong."""
    return Readings(dict(map(_choice, words)))


def single_changes() -> list[Readings]:
    """The default, and every alternative of one option with the defaults of all others."""
    others = [Readings({option.name: word}) for option in OPTIONS for word in list(option.alternatives)[1:]]
    return [DEFAULT, *others]


def _choice(words: str) -> tuple[str, str]:
    name, _, word = words.partition("=")
    options = {option.name: option for option in OPTIONS}
    if name not in options:
        raise UserError(f"--reading {words}: there is no option {name!r}; {nearest(name, list(options))}")
    if word not in options[name].alternatives:
        known = ", ".join(options[name].alternatives)
        raise UserError(f"--reading {words}: {name} can be {known}")
    return name, word
