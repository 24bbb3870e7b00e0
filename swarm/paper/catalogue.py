"""Which figures there are, and what a user may call them."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from swarm.errors import UserError, nearest
from swarm.paper import section_2_2, section_2_3_copying, section_2_3_given, section_2_4
from swarm.paper.study import Drawing, Figure, Study

FIGURES: dict[str, Callable[[], Figure]] = {
    "fig1": section_2_2.figure_1,
    "fig2": section_2_2.figure_2,
    "fig3": section_2_2.figure_3,
    "fig4": section_2_2.figure_4,
    "fig5": section_2_2.figure_5,
    "fig6": section_2_2.figure_6,
    "fig7": section_2_2.figure_7,
    "fig8": section_2_2.figure_8,
    "fig9": section_2_2.figure_9,
    "fig10": section_2_3_given.figure_10,
    "fig11": section_2_3_given.figure_11,
    "fig12": section_2_3_given.figure_12,
    "fig13": section_2_3_given.figure_13,
    "fig14": section_2_3_given.figure_14,
    "fig15": section_2_3_copying.figure_15,
    "fig16": section_2_3_copying.figure_16,
    "fig17": section_2_3_copying.figure_17,
    "fig18": section_2_3_copying.figure_18,
    "fig19": section_2_4.figure_19,
    "fig20": section_2_4.figure_20,
    "fig21": section_2_4.figure_21,
}
"""In the paper's order."""


def chosen_names(asked: Sequence[str]) -> list[str]:
    """The figures meant by words such as 3, fig3, figure3, "all" or my_study.py, each once.

    UserError for a word that means none of them.
    """
    names = [name for word in asked for name in _meant(word)]
    return list(dict.fromkeys(names))


def load_figure(name: str) -> Figure:
    """The study or drawing of this name, or the one that a user's file describes."""
    if name in FIGURES:
        return FIGURES[name]()
    figure = _called(name, _user_module(Path(name)).figure)
    if not isinstance(figure, Study | Drawing):
        raise UserError(f"{name}: its figure() returns no Study and no Drawing")
    return figure


def _meant(word: str) -> list[str]:
    if word.endswith(".py"):
        return [word]
    if word.lower() == "all":
        return list(FIGURES)
    name = re.sub(r"^(?:fig(?:ure)?[ ._-]?)?0*(?=\d)", "fig", word.lower())
    if name not in FIGURES:
        raise UserError(f"no figure {word!r} of the paper can be reproduced; {_hint(name)}")
    return [name]


def _hint(name: str) -> str:
    first, *_, last = FIGURES
    number = name.removeprefix("fig")
    if not number.isdecimal():
        hint = nearest(name, [*FIGURES, "all"])
        return hint if hint.startswith("did you") else f"known: {first}-{last} and all"
    close = min(FIGURES, key=lambda figure: abs(int(figure[3:]) - int(number)))
    return f"the nearest is {close!r} (figures {first[3:]}-{last[3:]} are of simulations)"


def _called(name: str, call: Callable[[], Any]) -> Any:
    """What a study file does; an error in it becomes one line."""
    try:
        return call()
    except UserError:
        raise
    except Exception as error:
        raise UserError(f"{name}: {type(error).__name__}: {' '.join(str(error).split())}") from error


def _user_module(path: Path) -> ModuleType:
    if not path.is_file():
        raise UserError(f"{path}: no such study file")
    spec = importlib.util.spec_from_file_location(f"user_study_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    loader = spec.loader
    _called(str(path), lambda: loader.exec_module(module))
    if not callable(getattr(module, "figure", None)):
        raise UserError(f"{path}: a study file has a function figure() that returns a Study")
    return module
