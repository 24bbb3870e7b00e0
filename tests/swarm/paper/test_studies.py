"""Studies as data: the catalogue, the conditions, the store and the estimate of the time left."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swarm.errors import RunFailedError, UserError
from swarm.files import write_whole
from swarm.gridworld.condition import Condition
from swarm.gridworld.simulation import Trace
from swarm.paper.catalogue import FIGURES, chosen_names, load_figure
from swarm.paper.claim import Better
from swarm.paper.conditions import COPYING_EACH_OTHER, NO_IMITATION, SMALL_NO_IMITATION
from swarm.paper.progress import TimeLeft, in_words
from swarm.paper.results import Results
from swarm.paper.runner import missing_tasks, runs_of_each
from swarm.paper.store import RunStore, Timing, open_store
from swarm.paper.study import Drawing, Study, learning_score
from tests.support.traces import made_up_trace

SHORT = replace(SMALL_NO_IMITATION, name="short", goal_reachings=None, steps=30, points=None)


def trace(*curves: list[int]) -> Trace:
    ratios = np.full((len(curves), 1), 0.5)
    return made_up_trace(np.array(curves, np.int32), ratios, steps=30)


@pytest.mark.parametrize("word", ["3", "fig3", "figure3", "Figure 3", "fig03", "FIG.3", "figure_03"])
def test_a_figure_has_many_names(word: str) -> None:
    assert chosen_names([word]) == ["fig3"]


def test_all_figures_once_and_in_order() -> None:
    assert list(FIGURES) == [f"fig{number}" for number in range(1, 22)]
    assert chosen_names(["fig5", "all", "5"])[:2] == ["fig5", "fig1"]
    assert len(chosen_names(["all", "all"])) == 21


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("fgi3", "did you mean 'fig3'"),
        ("figure33", "the nearest is 'fig21'"),
        ("0", "the nearest is 'fig1'"),
        ("al", "did you mean 'all'"),
        ("-3", "known: fig1-fig21 and all"),
        ("", "known: fig1-fig21 and all"),
        ("nowhere.py", "no such study file"),
    ],
)
def test_an_unknown_figure_names_the_nearest(word: str, hint: str) -> None:
    with pytest.raises(UserError, match=hint):
        [load_figure(name) for name in chosen_names([word])]


def test_each_name_means_the_figure_of_its_number() -> None:
    figures = {name: load_figure(name) for name in FIGURES}
    assert [figure.name for figure in figures.values()] == list(figures)
    drawings = [name for name, figure in figures.items() if isinstance(figure, Drawing)]
    assert drawings == ["fig1", "fig2", "fig4", "fig10", "fig11", "fig13"]


def all_conditions() -> list[Condition]:
    studies = [figure for name in FIGURES if isinstance(figure := load_figure(name), Study)]
    return [condition for study in studies for condition in study.series.values()]


def test_figures_share_conditions_and_no_name_means_two() -> None:
    shared = runs_of_each((condition, 100) for condition in all_conditions())
    assert len(shared) == 27
    assert len(all_conditions()) > 40


def test_the_papers_readings_are_those_of_every_condition() -> None:
    for condition in all_conditions():
        small = condition.arena.name == "open-10"
        assert condition.epsilon == (0.3 if small else 0.5)
        assert condition.evaluate_every == (10 if small else 1000)
        assert (condition.goal_reachings, condition.steps) == (
            (100_000, None) if small else (None, 20_000_000)
        )


def test_claims_compare_what_exists() -> None:
    known = {condition.name for condition in all_conditions()}
    for name in FIGURES:
        for claim in load_figure(name).claims:
            for check in claim.checks:
                if isinstance(check, Better):
                    assert {check.better.name, check.worse.name} <= known


def test_the_claims_that_must_be_covered_are() -> None:
    figures = {name for name in FIGURES if load_figure(name).claims}
    assert figures >= {f"fig{number}" for number in (3, 5, 6, 7, 8, 9, 12, 14, 15, 16, 17, 18, 19, 20, 21)}
    until = [
        check.end_step
        for name in ("fig12", "fig15", "fig16")
        for claim in load_figure(name).claims
        for check in claim.checks
        if isinstance(check, Better)
    ]
    assert until == [15_500_000] * 3


def test_two_conditions_of_one_name_are_refused() -> None:
    with pytest.raises(UserError, match="two different conditions are named 'no_imitation'"):
        runs_of_each([(NO_IMITATION, 1), (replace(NO_IMITATION, epsilon=0.1), 1)])


def test_a_name_that_is_no_file_name_is_refused() -> None:
    with pytest.raises(UserError, match="cannot name a study or a condition"):
        Study("../escape", "", {"a": SHORT}, 30)
    with pytest.raises(UserError, match="has no series"):
        Study("empty", "", {}, 30)


def test_what_is_saved_is_what_is_read(tmp_path: Path) -> None:
    store = open_store(tmp_path, seed=1, steps=None)
    store.admit(SHORT)
    assert not store.has(SHORT, 0)
    store.save(SHORT, 0, trace([90, 12, 9], [80, 10, 9]))
    assert store.has(SHORT, 0)
    store.save(SHORT, 1, trace([100, 100, 100], [100, 50, 9]))
    curves = Results(store, 2).curves(SHORT, 30)
    assert curves.times.tolist() == [10, 20, 30]
    assert curves.values.tolist() == [[85, 11, 9], [100, 75, 54.5]]  # two learners are one replicate
    assert curves.replicates == ((1, 0), (1, 1))
    assert Results(store, 2).ratios(SHORT).tolist() == [[0.5], [0.5]]


def test_a_file_cut_short_is_run_again_and_a_temporary_one_is_never_read(tmp_path: Path) -> None:
    store = open_store(tmp_path, seed=1, steps=None)
    store.admit(SHORT)
    store.save(SHORT, 0, trace([9, 9, 9]))
    store.save(SHORT, 1, trace([9, 9, 9]))
    path = tmp_path / "runs" / "short" / "00001.parquet"
    path.write_bytes(path.read_bytes()[:-20])
    path.with_name(".00002.parquet.77.tmp").write_bytes(b"PAR1 half PAR1")
    assert missing_tasks(store, {SHORT: 3}) == [(SHORT, 1), (SHORT, 2)]


def test_a_file_that_is_spoilt_inside_stops_with_the_cure(tmp_path: Path) -> None:
    store = open_store(tmp_path, seed=1, steps=None)
    store.admit(SHORT)
    (tmp_path / "runs" / "short" / "00000.parquet").write_bytes(b"PAR1 nonsense PAR1")
    with pytest.raises(RunFailedError, match=r"run 0 of short .* delete its file and start again"):
        Results(store, 1).curves(SHORT, 30)


def test_a_failed_write_leaves_neither_file(tmp_path: Path) -> None:
    def half(path: Path) -> None:
        path.write_text("half")
        raise OSError("no space left on device")

    with pytest.raises(RunFailedError, match="no space left on device"):
        write_whole(tmp_path / "result", half)
    assert list(tmp_path.iterdir()) == []


def test_a_directory_of_other_settings_is_refused_and_kept(tmp_path: Path) -> None:
    open_store(tmp_path / "out", seed=1, steps=200).admit(SHORT)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(UserError, match="with seed 1, but 2 was asked for; choose another --out"):
        open_store(tmp_path / "out", seed=2, steps=200)
    with pytest.raises(UserError, match="with steps 200, but null was asked for"):
        open_store(tmp_path / "out", seed=1, steps=None)
    changed = replace(SHORT, epsilon=0.9)
    with pytest.raises(UserError, match=r"epsilon 0\.3, but 0\.9 .* give the condition another name"):
        open_store(tmp_path / "out", seed=1, steps=200).admit(changed)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", ["notes.txt", "settings.json"])
def test_a_directory_of_something_else_is_refused_and_kept(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("mine")
    with pytest.raises(UserError, match="choose another --out"):
        open_store(tmp_path, seed=1, steps=None)
    assert (tmp_path / name).read_text() == "mine"
    with pytest.raises(UserError, match="cannot be used for results"):
        open_store(tmp_path / name, seed=1, steps=None)


def test_an_empty_directory_is_taken(tmp_path: Path) -> None:
    open_store(tmp_path, seed=1, steps=None)
    assert json.loads((tmp_path / "settings.json").read_text())["seed"] == 1


def test_a_timing_cut_short_is_passed_over(tmp_path: Path) -> None:
    store = open_store(tmp_path, seed=1, steps=None)
    store.add_timing(Timing("short", 0, 1.5, 30))
    with (tmp_path / "timings.jsonl").open("a") as file:
        file.write('\n{"condition": "sh')
    store.add_timing(Timing("short", 1, 2.5, 30))
    assert [timing.seconds for timing in store.timings().values()] == [1.5, 2.5]


def test_steps_cut_every_condition(tmp_path: Path) -> None:
    store = RunStore(tmp_path, seed=1, steps=5000)
    assert store.condition(COPYING_EACH_OTHER).point_limit == 5
    assert store.condition(SMALL_NO_IMITATION).point_limit == 500


def test_the_time_left_takes_each_condition_at_its_own_pace() -> None:
    left = TimeLeft({"quick": 1.0, "slow": 50.0}, {"quick": 3, "slow": 3}, workers=2)
    assert left.seconds is None
    left.finished("quick", 2.0)
    assert left.seconds == pytest.approx((2 * 2 + 3 * 100) / 2)
    left.finished("slow", 30.0)
    assert left.seconds == pytest.approx((2 * 2 + 2 * 30) / 2)
    for name in ("quick", "quick", "slow"):
        left.finished(name, 30.0 if name == "slow" else 2.0)
    assert left.seconds == pytest.approx(30.0)  # the last run has one worker only


def test_time_left_in_words() -> None:
    assert [in_words(seconds) for seconds in (None, 12.3, 600, 9000)] == [
        "estimating the time left",
        "about 12 s left",
        "about 10 min left",
        "about 2.5 h left",
    ]


def test_the_score_of_known_curves(tmp_path: Path) -> None:
    store = open_store(tmp_path, seed=1, steps=None)
    store.admit(SHORT)
    for run, lengths in enumerate(([30, 9, 9], [30, 30, 9], [30, 30, 30])):
        store.save(SHORT, run, trace(lengths))
    score = learning_score(Results(store, 3).curves(SHORT, 30), shortest_moves=9)
    assert score["mean_best_path_length"] == pytest.approx((48 + 69 + 90) / 9)
    assert score["median_steps_to_shortest"] == 30
    assert score["share_of_runs_that_found_it"] == pytest.approx(2 / 3)
