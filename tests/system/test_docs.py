"""The documentation's snippets are run, and its generated parts are those of the code."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory
from swarm.config.reference import experiment_reference, laboratory_reference

ROOT = Path(__file__).parents[2]
PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]
PACKAGES = ("swarm", "robot_agent", "tracker_bridge", "server")


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def snippets(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_experiment_and_laboratory_shown_can_be_loaded(page: Path, tmp_path: Path) -> None:
    for number, text in enumerate(snippets(page, "toml")):
        file = tmp_path / f"{number}.toml"
        file.write_text(text)
        if "[laboratory]" in text:
            assert Laboratory.load(file).robot
        else:
            assert Experiment.load(file).learners


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_python_snippet_runs(page: Path) -> None:
    for text in snippets(page, "python"):
        exec(compile(text, str(page), "exec"), {"__name__": "snippet"})


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_link_leads_to_a_file(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (page.parent / target).exists(), target


def folders_shown(page: Path) -> set[str]:
    """The folders of the tree in a page: lines such as `logs/   reading`, in the less indented ones above."""
    shown, above = set(), {0: ""}
    for indent, name in re.findall(r"^    ( *)([a-z_]+/) {2,}\S", page.read_text(encoding="utf-8"), re.M):
        folder = above[len(indent)] + name
        above[len(indent) + 2] = folder
        shown.add(folder.rstrip("/"))
    return shown


def test_the_tree_shown_is_that_of_the_packages() -> None:
    packages = {path.parent for top in PACKAGES for path in (ROOT / top).rglob("__init__.py")}
    assert folders_shown(ROOT / "docs" / "architecture.md") == {name_of(folder) for folder in packages}


@pytest.mark.parametrize(
    ("page", "reference"),
    [("experiment-file.md", experiment_reference), ("laboratory-file.md", laboratory_reference)],
)
def test_the_files_references_are_those_of_the_code(page: str, reference: Callable[[], str]) -> None:
    assert (ROOT / "docs" / page).read_text().endswith(reference())


@pytest.mark.parametrize("file", sorted((ROOT / "deploy" / "sim").glob("*.toml")), ids=lambda file: file.name)
def test_the_shipped_experiments_can_be_loaded(file: Path) -> None:
    assert Experiment.load(file).learners
