"""The documentation's snippets are run, and its generated parts are those of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from swarm.config.experiment import Experiment
from swarm.config.reference import markdown

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def snippets(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_experiment_shown_can_be_loaded(page: Path, tmp_path: Path) -> None:
    for number, text in enumerate(snippets(page, "toml")):
        file = tmp_path / f"{number}.toml"
        file.write_text(text)
        assert Experiment.load(file).learners


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_python_snippet_runs(page: Path) -> None:
    for text in snippets(page, "python"):
        exec(compile(text, str(page), "exec"), {"__name__": "snippet"})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_to_a_file(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (page.parent / target).exists(), target


def test_the_experiment_files_reference_is_that_of_the_code() -> None:
    assert (ROOT / "docs" / "experiment-file.md").read_text().endswith(markdown())


@pytest.mark.parametrize("file", sorted((ROOT / "deploy" / "sim").glob("*.toml")), ids=lambda file: file.name)
def test_the_shipped_experiments_can_be_loaded(file: Path) -> None:
    assert Experiment.load(file).learners
