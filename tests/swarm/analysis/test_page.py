"""The page to hand round: it shows what the logs say, whatever they call things, and nothing else runs."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from swarm.analysis.analyze import Request, analyze, verify
from swarm.analysis.page.document import page_text, read_page
from swarm.cli.app import app
from swarm.errors import RunFailedError, UserError
from swarm.replay.replay import Request as ReplayRequest
from swarm.replay.replay import replay_log
from tests.support.learnt_logs import ROBOT, learnt_log
from tests.support.small_logs import SmallLog, metadata

HOSTILE = "</script><script>document.title = 'taken'</script><img src=x onerror=alert(1)>"
CHROMIUM = shutil.which("chromium")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a robot that made 240 moves, with a path that was given and some that it saw."""
    log = tmp_path_factory.mktemp("run") / "trial-000.mcap"
    learnt_log(log, 240)
    return log


@pytest.fixture(scope="module")
def page(log: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("page") / "analysis"
    return analyze(Request([log], out, html=True)).files["report.html"]


def edited(page: Path, change: str, by: str, place: Path) -> Path:
    """The page with one text changed, still beside what its logs' places are counted from."""
    text = page.read_text()
    assert text.count(change) >= 1
    copy = page.with_name(place.name + ".html")
    copy.write_text(text.replace(change, by, 1))
    return copy


def test_every_number_is_that_of_the_logs(page: Path) -> None:
    found = verify(page)
    assert not found.differences
    assert found.own_script
    assert found.numbers > 240 * 6


def test_the_table_at_the_end_is_the_learner_s_own(page: Path, log: Path) -> None:
    """Made from the page as its script does, and by replaying the log."""
    (learning,) = read_page(page)["learning"]
    table = [[0.0] * 8 for _ in range(learning["columns"] * learning["rows"])]
    moves = zip(learning["state"], learning["action"], learning["q_value"], strict=True)
    for state, action, q_value in moves:
        table[state][action] = q_value
    replayed = replay_log(ReplayRequest((log,), ROBOT)).replays[ROBOT].learner.controller
    assert table == [pytest.approx(row, rel=1e-5) for row in replayed.q.snapshot()]
    memory = {each.number: replayed.memory.ratio(each) for each in replayed.memory.remembered}
    last = dict(zip(learning["replays"]["path"], learning["replays"]["ratio"], strict=True))
    assert {path: last.get(path, 1.0) for path in memory} == pytest.approx(memory, rel=1e-5)


@pytest.mark.parametrize(
    ("pattern", "by", "named"),
    [
        (r'"text":"240"', '"text":"250"', "Learning, given, moves, text"),
        (r'"q_value":\[0', '"q_value":[0.5', f"{ROBOT} in trial 0 of seed 1, q_value of move 1"),
        (r'"mean":\[\d+', '"mean":[3', "curve of given, mean at move 10"),
        (r'"messages":\d+', '"messages":1', "trial-000.mcap, messages"),
        (r'"cap":100', '"cap":90', "cap"),
    ],
)
def test_a_number_that_was_edited_is_named(
    page: Path, pattern: str, by: str, named: str, tmp_path: Path
) -> None:
    change = re.search(pattern, page.read_text())
    assert change
    changed = edited(page, change[0], by, tmp_path)
    (found,) = verify(changed).differences
    assert named in str(found)
    result = CliRunner().invoke(app, ["verify", str(changed)])
    assert isinstance(result.exception, RunFailedError)
    assert named in str(result.exception)


def test_another_script_is_remarked_on(page: Path, tmp_path: Path) -> None:
    changed = edited(page, "show(JSON.parse", "alert(1); show(JSON.parse", tmp_path)
    found = verify(changed)
    assert not found.differences
    assert not found.own_script


def test_a_page_whose_logs_moved_is_told_where_they_are(page: Path, log: Path, tmp_path: Path) -> None:
    away = tmp_path / "report.html"
    shutil.copy(page, away)
    with pytest.raises(UserError, match="say where its runs are"):
        verify(away)
    assert not verify(away, [log]).differences


@pytest.mark.parametrize(
    "text", ["", "<html></html>", '<script id="data">[]</script>', '<script id="data">{}</script>']
)
def test_what_is_no_page_is_refused(tmp_path: Path, text: str) -> None:
    place = tmp_path / "some.html"
    place.write_text(text)
    with pytest.raises(UserError, match=r"no report|does not say which runs"):
        verify(place)


def hostile_page(place: Path) -> Path:
    """Of a log that calls its run, a robot's condition and the commit by names that are scripts."""
    head = metadata(robots={"imitator": f"learner {HOSTILE.replace(' ', '')}"})
    head["run"]["name"] = HOSTILE
    head["versions"]["commit"] = HOSTILE
    log = SmallLog(place / "trial-000.mcap", head)
    log.add_curve("imitator", [50, 40, 9])
    return analyze(Request([log.close()], place / "analysis", html=True)).files["report.html"]


def test_no_name_ends_the_data(tmp_path: Path) -> None:
    text = hostile_page(tmp_path).read_text()
    assert text.count("<script") == text.count("</script>") == 2
    assert "<img" not in text
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)
    assert policy
    assert policy[1].startswith("default-src 'none'; ")


def shown_in_browser(page: Path, profile: Path) -> str:
    """What a browser makes of the page, without a network."""
    assert CHROMIUM
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}"]
    command += ["--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=2000", "--dump-dom"]
    done = subprocess.run([*command, page.as_uri()], capture_output=True, text=True, check=True)
    return done.stdout


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
def test_a_browser_shows_it_from_a_file(page: Path, tmp_path: Path) -> None:
    dom = shown_in_browser(page, tmp_path)
    main = dom[dom.index("<main") : dom.index("</main>")]
    contents: dict[str, Any] = read_page(page)
    for table in contents["tables"]:
        assert f">{table['title']}</h2>" in main
    assert "Move 240, journey" in main
    assert 'class="map"' in main


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
def test_in_a_browser_a_name_stays_a_name(tmp_path: Path) -> None:
    dom = shown_in_browser(hostile_page(tmp_path), tmp_path / "profile")
    assert "<title>taken" not in dom
    assert "&lt;/script&gt;&lt;script&gt;document.title" in dom[dom.index("<main") :]
    assert "<img" not in dom


def test_the_log_s_order_does_not_change_the_page(page: Path) -> None:
    contents = read_page(page)
    assert page_text(json.loads(json.dumps(contents))) == page.read_text()
