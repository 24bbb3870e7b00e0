"""Which figures there are, and what a user may call them."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from swarm import paper
from swarm.errors import UserError, nearest
from swarm.paper.claim import Claim
from swarm.paper.study import Drawing, Figure, Study

_MODULE = re.compile(r"figure_(\d\d)")


def figure_names() -> list[str]:
    """fig1, fig2, ... in the paper's order: one for each file of `swarm.paper`."""
    found = (_MODULE.fullmatch(module.name) for module in pkgutil.iter_modules(paper.__path__))
    return [f"fig{number}" for number in sorted(int(match[1]) for match in found if match)]


def chosen_names(asked: Sequence[str]) -> list[str]:
    """The figures meant by words such as 3, fig3, figure3, "all" or my_study.py, each once.

    UserError for a word that means none of them.
    """
    names = [name for word in asked for name in _meant(word)]
    return list(dict.fromkeys(names))


def load_figure(name: str) -> Figure:
    """The study or drawing that the file of this figure describes."""
    figure = _called(name, _module(name).figure)
    if not isinstance(figure, Study | Drawing):
        raise UserError(f"{name}: its figure() returns no Study and no Drawing")
    return figure


def load_claims(names: Iterable[str]) -> list[Claim]:
    """What the paper says about these figures, in its order."""
    modules = {name: _module(name) for name in names}
    found = (_called(name, module.claims) for name, module in modules.items() if hasattr(module, "claims"))
    return [claim for claims in found for claim in claims]


def _meant(word: str) -> list[str]:
    known = figure_names()
    if word.endswith(".py"):
        return [word]
    if word.lower() == "all":
        return known
    name = re.sub(r"^(?:fig(?:ure)?[ ._-]?)?0*(?=\d)", "fig", word.lower())
    if name not in known:
        raise UserError(f"no figure {word!r} of the paper can be reproduced; {_hint(name, known)}")
    return [name]


def _hint(name: str, known: list[str]) -> str:
    number = re.fullmatch(r"fig(\d+)", name)
    if number is None:
        hint = nearest(name, [*known, "all"])
        return hint if hint.startswith("did you") else f"known: {known[0]}-{known[-1]} and all"
    close = min(known, key=lambda figure: abs(int(figure[3:]) - int(number[1])))
    return f"the nearest is {close!r} (figures {known[0][3:]}-{known[-1][3:]} are of simulations)"


def _module(name: str) -> ModuleType:
    if name.endswith(".py"):
        return _user_module(Path(name))
    return importlib.import_module(f"{paper.__name__}.figure_{int(name[3:]):02}")


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
