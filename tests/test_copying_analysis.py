"""What `swarm analyze` makes of visits: errors by kind, paths by enactment, figures and a section."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.analysis.copied_paths import error_kind
from swarm.analysis.copying_figures import chosen_copies
from swarm.analysis.run_analysis import Analysis, Request, analyze
from swarm.geometry import Move
from swarm.messages import swarm_pb2 as pb
from tests.small_logs import SmallLog

SE, E, S = int(Move.SE), int(Move.E), int(Move.S)


@pytest.mark.parametrize(
    ("copied", "real", "kind"),
    [
        ((SE, SE), (SE, SE), "perfect"),
        ((SE, SE, SE), (SE, SE), "one move extra"),
        ((SE,), (SE, SE), "one move lost"),
        ((SE, E), (SE, SE), "one heading wrong"),
        ((E, E, S), (SE, SE), "several"),
    ],
)
def test_errors_by_kind(copied: tuple[int, ...], real: tuple[int, ...], kind: str) -> None:
    assert error_kind(copied, real) == kind


def visit(log: SmallLog, number: int, moves: list[int], real: list[int], ratios: list[float]) -> None:
    """A path copied in a visit, the server's judgement, and a replay for each R."""
    log.add("robot/imitator/path", pb.PathRemembered(path=number, moves=moves, source="camera", visit=number))
    log.add("robot/imitator/visit", pb.Visit(visit=number, phase=pb.Visit.DONE, path=number))
    error = pb.CopyError(visit=number, path=number, true_moves=real, copied_moves=moves)
    log.add("server/imitator/copy_error", error)
    for place, ratio in enumerate(ratios):
        log.add("robot/imitator/replay", pb.Replay(path=number, ratio=ratio, started_move=10 * place + 1))


@pytest.fixture
def analysis(tmp_path: Path) -> Analysis:
    log = SmallLog(tmp_path / "visits.mcap")
    log.add_curve("imitator", [100, 50, 9])
    visit(log, 1, [SE, SE, SE], [SE, SE, SE], [1.0, 0.8, 0.75])
    visit(log, 2, [SE, SE, S], [SE, SE, SE], [0.5])
    log.add("robot/imitator/visit", pb.Visit(visit=3, phase=pb.Visit.DONE, reason="the image is dark"))
    return analyze(Request([log.close()]))


def test_paths_are_judged_and_counted(analysis: Analysis) -> None:
    copying = analysis.as_json()["copying"]
    assert copying["visits"] == 3
    assert copying["failed_visits"] == {"the image is dark": 1}
    assert copying["errors"] == {"perfect": 1, "one heading wrong": 1}
    assert copying["perfect"] == {"paths": 1, "replays": 3, "mean_ratio": 0.75}
    assert copying["miscopied"] == {"paths": 1, "replays": 1, "mean_ratio": 0.5}


def test_the_most_enacted_come_first(analysis: Analysis) -> None:
    copying = analysis.summary.copying
    assert [path.path for path in copying.enacted] == [1, 2]
    assert [path.path for path in chosen_copies(copying)] == [1, 2]


def test_figures_and_section_are_written(analysis: Analysis) -> None:
    report = analysis.files["report.md"].read_text()
    assert "## Copying" in report
    assert "| learnt nothing: the image is dark | 1 |" in report
    for name in ("most_enacted.png", "least_enacted.png", "copies.png", "ratios.png"):
        assert analysis.files[name].read_bytes().startswith(b"\x89PNG")
        assert f"]({name})" in report


def test_a_run_without_paths_says_nothing_of_copying(tmp_path: Path) -> None:
    log = SmallLog(tmp_path / "alone.mcap")
    log.add_curve("loner", [100, 90])
    found = analyze(Request([log.close()]))
    assert "## Copying" not in found.files["report.md"].read_text()
    assert "copies.png" not in found.files
