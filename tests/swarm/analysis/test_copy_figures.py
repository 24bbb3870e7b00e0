"""Figures 27 to 29 of any run: paths by enactment, copies by error, R over time, and the data behind."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from swarm.analysis.analyze import Analysis, Request, analyze
from swarm.analysis.copying.drawing import LEAST_SIDE, moves_text, places, square_around
from swarm.analysis.copying.errors import Differences, contains, differences, error_kind
from swarm.analysis.copying.figures import colour_of, copying_figures, plot_copies, plot_paths
from swarm.analysis.copying.paths import LoggedPath
from swarm.analysis.copying.ratios import apart, ratio_lines
from swarm.analysis.copying.summary import Copying, chosen_copies, least_enacted, most_enacted, reason_kind
from swarm.geometry import Move
from swarm.messages import swarm_pb2 as pb
from tests.support.small_logs import SmallLog, metadata

SE, E, S, NW = int(Move.SE), int(Move.E), int(Move.S), int(Move.NW)
PICTURES = ("most_enacted.png", "least_enacted.png", "copies.png", "ratios.png", "curves_paper_axes.png")
WATCHING = ("visit_phases", "visits", "observations", "looks", "smoothed", "segments", "copy_errors")


@pytest.mark.parametrize(
    ("copied", "real", "kind", "wrong"),
    [
        ((SE, SE), (SE, SE), "perfect", ([], [])),
        ((SE, SE, SE), (SE, SE), "one move extra", ([2], [])),
        ((NW, SE, SE), (SE, SE), "one move extra", ([0], [])),
        ((SE,), (SE, SE), "one move lost", ([], [1])),
        ((SE, S, E), (SE, E, E), "one heading wrong", ([1], [1])),
        ((E, E, S), (SE, SE), "several errors", ([0, 1, 2], [0, 1])),
        ((), (SE, SE), "several errors", ([], [0, 1])),
    ],
)
def test_errors_by_kind_and_place(
    copied: Sequence[int], real: Sequence[int], kind: str, wrong: tuple[list[int], list[int]]
) -> None:
    assert error_kind(copied, real) == kind
    assert differences(copied, real) == Differences(frozenset(wrong[0]), frozenset(wrong[1]))


def test_a_remembered_stretch_may_be_true_although_the_copy_is_wrong() -> None:
    assert contains((SE, E, S), (E, S))
    assert not contains((SE, E, S), (SE, S))
    assert not contains((SE,), (SE, SE))


def test_reasons_that_differ_in_numbers_are_one_reason() -> None:
    first = reason_kind("the demonstrator was lost in 60 of 150 frames")
    assert first == reason_kind("the demonstrator was lost in 7 of 30 frames")
    assert first != reason_kind("the demonstrator stood still")


def test_moves_lead_from_cell_to_cell_and_are_told_in_words() -> None:
    assert places([SE, E, NW]) == [(0, 0), (1, 1), (2, 1), (1, 0)]
    assert moves_text([NW, NW, SE]) == "2 NW, 1 SE"
    assert moves_text([]) == "no move"


def test_a_picture_has_room_for_its_longest_line() -> None:
    square = square_around(places([E] * 9), [(4.5, -2.0)])
    assert square.middle == (4.5, -1.0)
    assert square.side > 9
    assert square_around(places([E])).side == LEAST_SIDE


def test_labels_keep_apart_in_order_and_stay_where_there_is_room() -> None:
    np.testing.assert_allclose(apart([0.1, 0.9, 0.5], 0.1, 1.0), [0.1, 0.9, 0.5])
    crowded = apart([0.5, 0.52, 0.5, 0.1], 0.1, 1.0)
    np.testing.assert_allclose(np.sort(crowded), [0.1, 0.5067 - 0.1, 0.5067, 0.5067 + 0.1], atol=1e-4)
    assert np.argsort(crowded, kind="stable").tolist() == [3, 0, 2, 1]
    np.testing.assert_allclose(apart([1.0, 1.0], 0.1, 1.0), [0.9, 1.0])


def path(number: int, replays: int, copied: Sequence[int] | None = None, ratio: float = 0.5) -> LoggedPath:
    """A path whose demonstrator made three moves SE; without `copied` one that was given."""
    return LoggedPath(
        log="a.mcap",
        condition="imitation",
        robot="imitator",
        seed=1,
        trial=0,
        path=number,
        visit=number if copied else 0,
        moves=tuple(copied or (SE,)),
        source="camera" if copied else "given",
        known_from=10 * number,
        known_for=100 - 10 * number,
        replays=replays,
        ratio=ratio,
        real=(SE, SE, SE) if copied else None,
        copied=tuple(copied) if copied else None,
    )


def copying(*paths: LoggedPath) -> Copying:
    return Copying(paths, NO_REPLAYS, visits=0, failures={}, seen={})


NO_REPLAYS = pl.DataFrame(
    schema={
        "log": pl.String,
        "robot": pl.String,
        "path": pl.Int64,
        "receive_t_ns": pl.Int64,
        "started_move": pl.Int64,
        "moves": pl.Int64,
        "ratio": pl.Float64,
    }
)


def numbers(paths: Sequence[LoggedPath]) -> list[int]:
    return [found.path for found in paths]


def test_the_most_and_the_least_enacted_share_no_path() -> None:
    few = copying(path(1, 5), path(2, 9), path(3, 0))
    assert numbers(most_enacted(few)) == [2, 1]
    assert numbers(least_enacted(few)) == [3]
    many = copying(*(path(number, number) for number in range(1, 11)))
    assert numbers(most_enacted(many)) == [10, 9, 8, 7]
    assert numbers(least_enacted(many)) == [1, 2, 3, 4]
    assert numbers(least_enacted(copying(path(1, 5)))) == [1]


def test_of_equally_enacted_paths_the_higher_ratio_comes_first() -> None:
    assert numbers(copying(path(1, 5, ratio=0.2), path(2, 5, ratio=0.8)).enacted) == [2, 1]


def test_the_copies_shown_are_the_most_enacted_and_the_worst() -> None:
    perfect, lost, bad, worst = (SE, SE, SE), (SE, SE), (SE, S, S), (NW, NW, NW, NW)
    found = copying(
        path(1, 1, perfect),
        path(2, 9, lost),
        path(3, 0, worst),
        path(4, 8, perfect),
        path(5, 3, bad),
        path(6, 99),
    )
    assert numbers(chosen_copies(found.enacted)) == [2, 4, 3, 5]
    assert numbers(found.miscopied) == [2, 5, 3]
    assert numbers(found.perfect) == [4, 1]


def test_perfect_wrong_and_given_paths_differ_in_colour() -> None:
    assert (
        len({colour_of(path(1, 1, (SE, SE, SE))), colour_of(path(1, 1, (SE,))), colour_of(path(1, 1))}) == 3
    )


def test_given_paths_without_replays_are_drawn_too_and_nothing_is_drawn_of_none() -> None:
    assert copying_figures(copying(path(1, 0))).keys() == {
        "most_enacted.png",
        "least_enacted.png",
        "ratios.png",
    }
    assert copying_figures(copying()) == {}
    assert not copying()


def test_a_figure_has_a_panel_for_each_path_and_two_for_each_copy() -> None:
    paths = [path(1, 1, (SE, SE, SE)), path(2, 5, (NW,)), path(3, 2)]
    assert len(plot_paths(paths, "paths").axes) == 3
    assert len(plot_copies(paths[:2], copying(*paths)).axes) == 4


def misplaced(figure: Figure) -> list[tuple[str, ...]]:
    """The texts of a figure that lie over each other, or beyond its edge."""
    figure.draw_without_rendering()
    texts = [text for text in figure.findobj(Text) if isinstance(text, Text) and text.get_text()]
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts]
    width_px, height_px = figure.bbox.size
    beyond = [(text,) for text, box in boxes if box.x1 > width_px or box.y1 > height_px or min(box.min) < 0]
    over = [(a, b) for (a, one), (b, other) in itertools.combinations(boxes, 2) if one.overlaps(other)]
    return [*beyond, *over]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_every_text_of_a_figure_has_its_own_place_in_it(count: int) -> None:
    paths = [path(number, number, (SE, SE, S, E, NW) * number) for number in range(1, count + 1)]
    drawn = [plot_paths(paths, "Paths enacted most often"), plot_copies(paths, copying(*paths))]
    assert [misplaced(figure) for figure in drawn] == [[], []]


def test_r_begins_at_1_when_a_path_is_remembered_and_holds_to_the_end() -> None:
    replays = pl.DataFrame(
        {
            "log": "a.mcap",
            "robot": "imitator",
            "path": [1, 1, 7],
            "receive_t_ns": [2, 1, 3],
            "started_move": [31, 12, 1],
            "moves": [5, 3, 1],
            "ratio": [0.33, 0.5, 0.9],
        }
    )
    replayed, unused = ratio_lines([path(1, 2), path(2, 0)], replays)
    assert replayed.moves == [10, 14, 35, 100]
    assert replayed.ratios == [1.0, 0.5, 0.33, 0.33]
    assert (unused.moves, unused.ratios) == ([20, 100], [1.0, 1.0])


def add_visit(
    log: SmallLog, number: int, moves: Sequence[int], real: Sequence[int], ratios: Sequence[float]
) -> None:
    """A visit as the robot and the server tell of it, and a replay of its path for each R."""
    robot = "robot/imitator"
    began_t_ns = log.t_ns
    observation = pb.Observation(visit=number, profile="best", frames=4, moves=moves, window=moves)
    for place in range(4):
        t_ns = began_t_ns + place
        observation.looks.add(captured_t_ns=t_ns, range_m=0.5, frame_hash=2**64 - 1)
        observation.smoothed.add(captured_t_ns=t_ns, x_m=0.5 + 0.1 * place, y_m=0.9 - 0.05 * place)
    observation.segments.add(length_m=0.2, began_t_ns=began_t_ns + 1, ended_t_ns=began_t_ns + 3)
    log.add(f"{robot}/observation", observation)
    log.add(f"{robot}/path", pb.PathRemembered(path=number, moves=moves, source="camera", visit=number))
    log.add(f"{robot}/visit", pb.Visit(visit=number, phase=pb.Visit.DONE, path=number))
    error = pb.CopyError(visit=number, path=number, true_moves=real, copied_moves=moves)
    log.add("server/imitator/copy_error", error)
    for place, ratio in enumerate(ratios):
        replay = pb.Replay(path=number, ratio=ratio, moves=2, started_move=10 * place + 1)
        log.add(f"{robot}/replay", replay)


@pytest.fixture(scope="module")
def analysis(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    head = metadata() | {"experiment": {"toml": "[arena]\ncell_m = 0.1\n"}}
    log = SmallLog(tmp_path_factory.mktemp("run") / "visits.mcap", head)
    log.add_curve("imitator", [100, 50, 9])
    log.add("robot/imitator/move", pb.Move(number=1))
    add_visit(log, 1, [SE, SE, SE], [SE, SE, SE], [1.0, 0.8, 0.75])
    log.add("robot/imitator/move", pb.Move(number=2))
    add_visit(log, 2, [SE, SE, S], [SE, SE, SE], [0.5])
    add_visit(log, 3, [E, E], [E, E, E], [])
    log.add("robot/imitator/path", pb.PathRemembered(path=4, moves=[NW], source="given"))
    log.add("robot/imitator/replay", pb.Replay(path=4, ratio=0.25, moves=1, started_move=1))
    for number in (4, 5):
        reason = f"the demonstrator was lost in {number} of 9 frames"
        log.add("robot/imitator/observation", pb.Observation(visit=number, frames=9, reason=reason))
        log.add("robot/imitator/visit", pb.Visit(visit=number, phase=pb.Visit.DONE, reason=reason))
    for number in (3, 20):
        log.add("robot/imitator/move", pb.Move(number=number))
    return analyze(Request([log.close()]))


def table(analysis: Analysis, name: str) -> pl.DataFrame:
    return pl.read_parquet(analysis.files[name])


def test_paths_are_judged_and_counted(analysis: Analysis) -> None:
    found = analysis.as_json()["copying"]
    assert (found["visits"], found["paths"]) == (5, 4)
    assert found["failed_visits"] == {"the demonstrator was lost in n of n frames": 2}
    assert {kind: count for kind, count in found["errors"].items() if count} == {
        "perfect": 1,
        "one move lost": 1,
        "one heading wrong": 1,
    }
    assert found["perfect"] == {"paths": 1, "replays": 3, "mean_ratio": 0.75, "highest_ratio": 0.75}
    assert found["miscopied"] == {"paths": 2, "replays": 1, "mean_ratio": 0.75, "highest_ratio": 1.0}
    assert found["miscopied_and_never_made"]["paths"] == 1
    assert [brief["path"] for brief in found["miscopied_paths"]] == [2, 3]
    assert [brief["path"] for brief in found["most_enacted"]] == [1, 2]
    assert [brief["path"] for brief in found["least_enacted"]] == [3, 4]


def test_every_path_is_a_row_with_its_fate(analysis: Analysis) -> None:
    rows = table(analysis, "copied_paths").sort("path").rows(named=True)
    assert [row["replays"] for row in rows] == [3, 1, 0, 1]
    assert [row["ratio"] for row in rows] == [0.75, 0.5, 1.0, 0.25]
    assert [row["edit_distance"] for row in rows] == [0, 1, 1, None]
    assert [row["really_made"] for row in rows] == [True, False, True, None]
    assert [(row["known_from"], row["known_for"]) for row in rows] == [(1, 19), (2, 18), (2, 18), (2, 18)]
    assert rows[1]["moves"] == ["SE", "SE", "S"]
    assert (rows[3]["source"], rows[3]["visit"], rows[3]["copied"]) == ("given", 0, None)


def test_the_seen_positions_are_those_of_the_demonstration_in_cells(analysis: Analysis) -> None:
    seen = analysis.summary.copying.seen
    assert sorted(path.path for path in seen) == [1, 2, 3]
    for positions in seen.values():
        np.testing.assert_allclose(positions, [(0, 0), (1, 0.5), (2, 1)])


def test_an_observation_is_a_row_and_so_is_every_look_position_and_segment(analysis: Analysis) -> None:
    observations = table(analysis, "observations")
    assert observations["visit"].to_list() == [1, 2, 3, 4, 5]
    assert observations["window"].to_list()[:2] == [["SE", "SE", "SE"], ["SE", "SE", "S"]]
    assert "looks" not in observations.columns
    looks = table(analysis, "looks")
    assert looks["visit"].to_list() == [1] * 4 + [2] * 4 + [3] * 4
    assert looks["place"].to_list() == [0, 1, 2, 3] * 3
    assert looks["frame_hash"].unique().to_list() == [2**64 - 1]
    assert set(looks["condition"]) == {"imitation"}
    assert table(analysis, "smoothed")["x_m"].to_list()[:2] == [0.5, 0.6]
    assert table(analysis, "segments")["length_m"].to_list() == [0.2] * 3
    assert table(analysis, "copy_errors")["robot"].unique().to_list() == ["imitator"]
    assert table(analysis, "visit_phases")["phase"].to_list() == ["DONE"] * 5


def test_figures_and_section_are_written(analysis: Analysis) -> None:
    report = analysis.files["report.md"].read_text()
    assert "5 visits, 2 of which taught nothing" in report
    assert "| the demonstrator was lost in n of n frames | 2 |" in report
    assert "| one heading wrong | 1 |" in report
    assert "| imitator | 1 | 0 | 2 | 2 SE, 1 S | one heading wrong | 1 | 1 | 0.50 |" in report
    for name in PICTURES:
        assert analysis.files[name].read_bytes().startswith(b"\x89PNG")
        assert f"]({name})" in report


def test_a_log_without_the_servers_judgement_still_shows_the_paths(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "log.mcap")
    log.add_curve("imitator", [100])
    log.add("robot/imitator/path", pb.PathRemembered(path=1, moves=[SE], source="camera", visit=1))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.DONE, path=1))
    found = analyze(Request([log.close()]))
    assert "most_enacted.png" in found.files
    assert "copies.png" not in found.files
    assert "Copying errors" not in found.files["report.md"].read_text()


def test_a_run_without_paths_says_nothing_of_copying(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "alone.mcap")
    log.add_curve("loner", [100, 90])
    found = analyze(Request([log.close()]))
    assert "## Copying" not in found.files["report.md"].read_text()
    assert "copying" not in found.as_json()
    assert not found.files.keys() & {*PICTURES, *WATCHING, "copied_paths"}
    tables = {file.stem for file in (found.directory / "tables").iterdir()}
    assert not tables & {*WATCHING, "copied_paths"}
