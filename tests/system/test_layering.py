"""Who may import whom, read off the source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.swarm_runs import ROOT

LAYERS = ("swarm", "robot_agent", "tracker_bridge", "server")
ALLOWED = {
    "swarm": {"swarm"},
    "robot_agent": {"swarm", "robot_agent"},
    "tracker_bridge": {"swarm", "tracker_bridge"},
    "server": {"swarm", "server"},
}
SLEEP = "sleep"


def sources(folder: str) -> list[Path]:
    return sorted(path for path in (ROOT / folder).rglob("*.py") if not path.name.endswith("_pb2.py"))


def imported(path: Path) -> Iterator[str]:
    """Every module that a file imports, wherever in the file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("layer", LAYERS)
def test_layers_import_only_what_they_may(layer: str) -> None:
    files = sources(layer)
    assert len(files) > 3
    for path in files:
        ours = {module.split(".")[0] for module in imported(path)} & {*LAYERS, "tests"}
        assert ours <= ALLOWED[layer], f"{name_of(path)} imports {ours - ALLOWED[layer]}"


def importers(package: str) -> set[str]:
    return {
        name_of(path)
        for layer in LAYERS
        for path in sources(layer)
        if any(module.split(".")[0] == package for module in imported(path))
    }


def test_zenoh_is_imported_by_the_bus_alone() -> None:
    assert importers("zenoh") == {"swarm/runtime/zenoh_session.py"}


def test_mcap_is_imported_by_the_recorder_and_the_log_reader_alone() -> None:
    assert importers("small_mcap") == {"server/recording/recorder.py", "swarm/logs/recover.py"}
    readers = importers("mcap")
    assert readers
    assert all(name.startswith("swarm/logs/") for name in readers)


def test_the_learning_rules_know_nothing_of_the_wire() -> None:
    for path in sources("swarm/learning"):
        wire = {"swarm.runtime", "swarm.messages", "google"}
        assert not wire & {".".join(module.split(".")[:2]) for module in imported(path)}, name_of(path)


def reached_from(module: str) -> set[str]:
    """Our own modules that a module imports, by itself or through others."""
    reached: set[str] = set()
    waiting = [module]
    while waiting:
        path = ROOT / f"{waiting.pop().replace('.', '/')}.py"
        if path.exists() and name_of(path) not in reached:
            reached.add(name_of(path))
            waiting += imported(path)
    return reached


def test_the_agent_does_not_know_whether_it_is_simulated() -> None:
    """Simulation is one more driver: nothing that the loop is made of reaches it."""
    reached = reached_from("robot_agent.agent")
    assert {
        "robot_agent/navigation/motion.py",
        "robot_agent/drivers/interfaces.py",
        "swarm/geometry.py",
    } <= reached
    assert not [name for name in reached if "sim" in Path(name).stem.split("_")]


def test_only_clocks_sleep() -> None:
    sleepers = {
        name_of(path)
        for folder in (*LAYERS, "tests")
        for path in sources(folder)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr == SLEEP
    }
    assert sleepers == {"swarm/clock.py"}


def test_tests_use_the_real_thing() -> None:
    for path in sources("tests"):
        assert "unittest.mock" not in set(imported(path)), name_of(path)


def test_nothing_is_pickled() -> None:
    for folder in LAYERS:
        for path in sources(folder):
            assert not {"pickle", "shelve", "marshal"} & set(imported(path)), name_of(path)
