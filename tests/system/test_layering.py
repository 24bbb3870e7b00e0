"""What the source may not do; who may import whom is held by the contracts in pyproject.toml."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.support.swarm_runs import ROOT

LAYERS = ("swarm", "robot_agent", "tracker_bridge", "server")
SLEEP = "sleep"
LINT_IMPORTS = "from importlinter.cli import lint_imports_command; lint_imports_command()"


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


def test_only_clocks_sleep() -> None:
    sleepers = {
        name_of(path)
        for folder in (*LAYERS, "tests")
        for path in sources(folder)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr == SLEEP
    }
    on_boards = "swarm/deployment/board/waiting.py"  # for services, which tell their manager alone
    assert sleepers == {"swarm/clock.py", on_boards}


def test_tests_use_the_real_thing() -> None:
    for path in sources("tests"):
        assert "unittest.mock" not in set(imported(path)), name_of(path)


def test_the_contracts_name_an_arrow_that_breaks_them(tmp_path: Path) -> None:
    """A copy of the source in which a driver's neighbour imports Zenoh."""
    for folder in LAYERS:
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    (tmp_path / "robot_agent" / "secret.py").write_text("import server.trial\nimport zenoh\n")
    command = [sys.executable, "-c", LINT_IMPORTS, "--no-cache"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    assert "robot_agent.secret -> server.trial" in done.stdout
    assert "robot_agent.secret -> zenoh" in done.stdout


def test_nothing_is_pickled() -> None:
    for folder in LAYERS:
        for path in sources(folder):
            assert not {"pickle", "shelve", "marshal"} & set(imported(path)), name_of(path)
