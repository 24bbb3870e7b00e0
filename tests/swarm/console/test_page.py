"""The page in a real browser: what a person sees and presses. Needs the extra `browser`, and Chromium."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from swarm.console.guard import Roles
from swarm.console.page_server import PAGE
from swarm.messages import swarm_pb2 as pb
from tests.support.console_server import Served
from tests.support.small_logs import SmallLog, metadata
from tests.support.swarm_runs import ROOT

sync_api = pytest.importorskip("playwright.sync_api", reason="needs the extra `browser`")
axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs the extra `browser`")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium (Debian: apt install chromium)"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:playwright"),
]
SCRIPT = "<img src=x onerror=document.title='broken'><script>document.title='broken'</script>"
"""What somebody may put where words are expected."""
MOVES = 30
CONTRAST = 4.5
"""Of text against its background (WCAG 2.2, 1.4.3)."""


def wicked_log(path: Path) -> Path:
    """A small log, whose events, reasons and condition are markup."""
    text = (ROOT / "deploy" / "sim" / "demo.toml").read_text().replace('name = "demo"', 'name = "wicked"')
    log = SmallLog(path, {**metadata(), "experiment": {"toml": text}})
    log.add("run/state", pb.RunState(phase=pb.RunState.RUNNING))
    for number in range(1, MOVES + 1):
        for robot in ("expert", "imitator", "loner"):
            log.add(f"robot/{robot}/pose", pb.Pose(x_m=1.0 + number / 50, y_m=1.0, theta_rad=0.1))
        move = pb.Move(number=number, state=number, action=0, next_state=number + 1, q_value=number / 40)
        log.add("robot/loner/move", move)
        log.add("robot/imitator/move", move)
        log.add("robot/imitator/status", pb.Status(activity=SCRIPT, moves=number))
    log.add("robot/imitator/path", pb.PathRemembered(path=1, moves=[1, 1], source=SCRIPT))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.WATCHING))
    log.add("robot/imitator/visit", pb.Visit(visit=1, phase=pb.Visit.DONE, path=1, reason=SCRIPT))
    log.add("server/event", pb.Event(level=pb.Event.WARNING, name="gone", text=SCRIPT))
    return log.close()


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with Served(wicked_log(tmp_path_factory.mktemp("page") / "trial-000.mcap"), Roles()) as server:
        yield server


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture
def page(served: Served, browser: Any) -> Iterator[Any]:
    """A page that shows the last moment; whatever goes wrong in it fails the test."""
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.set_default_timeout(0)
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("console", lambda message: troubles.append(message.text))
    page.goto(f"http://127.0.0.1:{served.port}/")
    page.wait_for_selector("#phase[data-phase=running]")
    page.keyboard.press("End")
    page.get_by_text(f"{MOVES} of 100 moves").wait_for()
    yield page
    page.close()
    assert troubles == []


def test_words_of_a_log_stay_words(page: Any) -> None:
    page.get_by_text(SCRIPT).first.wait_for()
    assert page.locator("#events").inner_text().count(SCRIPT) == 1
    assert page.locator("main img, main script").count() == 0
    assert page.title() == "Swarm console"


def test_keys_go_through_the_run(page: Any) -> None:
    page.keyboard.press("Home")
    page.locator("#clock", has_text="0:00:00 /").wait_for()
    page.keyboard.press("ArrowRight")
    page.get_by_text("1 of 100 moves").wait_for()
    page.keyboard.press("ArrowRight")
    page.get_by_text("2 of 100 moves").wait_for()
    page.keyboard.press("ArrowLeft")
    page.get_by_text("1 of 100 moves").wait_for()
    page.keyboard.press("2")
    page.locator("#learners button[aria-pressed=true]", has_text="loner").wait_for()
    page.keyboard.press(" ")
    page.get_by_label("Pause", exact=True).wait_for()
    page.keyboard.press("?")
    page.locator("#help[open]").wait_for()
    page.keyboard.press("Escape")


def test_a_move_is_gone_to_and_its_table_read_by_keyboard(page: Any) -> None:
    page.get_by_label("move of imitator").fill("7")
    page.keyboard.press("Enter")
    page.get_by_text("7 of 100 moves").wait_for()
    page.locator("#q-table").focus()
    for _ in range(7):
        page.keyboard.press("ArrowRight")
    page.get_by_text("Cell 7: E 0.175").wait_for()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1440, 900), (820, 1180)])
def test_axe_finds_nothing(served: Served, browser: Any, scheme: str, size: tuple[int, int]) -> None:
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=scheme, bypass_csp=True
    )
    page = context.new_page()
    page.goto(f"http://127.0.0.1:{served.port}/")
    page.wait_for_selector("#phase[data-phase=running]")
    found = axe.Axe().run(page).response["violations"]
    assert [(rule["id"], rule["nodes"][0]["html"]) for rule in found] == []
    context.close()


def test_a_page_comes_back_when_its_server_does(tmp_path: Path, browser: Any) -> None:
    log = wicked_log(tmp_path / "trial-000.mcap")
    with Served(log, Roles()) as first:
        page = browser.new_page()
        page.set_default_timeout(0)
        page.goto(f"http://127.0.0.1:{first.port}/")
        page.wait_for_selector("#phase[data-phase=running]")
    page.get_by_text("the console's server is gone").wait_for()
    with Served(log, Roles(), first.port):
        page.get_by_text("the whole log is read").wait_for()
    page.close()


def luminance(colour: str) -> float:
    """Of #rrggbb, relative (WCAG)."""
    channels = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_text_stands_out_from_what_it_stands_on(theme: int) -> None:
    """Axe leaves out what scrolls; so every colour of text is measured against every ground it may have."""
    blocks = (PAGE / "console.css").read_text().split(":root {")[1:]
    words = [line.strip().rstrip(";").split(": ") for line in blocks[theme].split("}")[0].splitlines()]
    colours = {
        name[2:]: value for name, value in (word for word in words if len(word) == 2 and "#" in word[1])
    }
    for ink in ("ink", "quiet", "good", "warn", "bad", "path"):
        for ground in ("panel", "cell", "floor"):
            light, dark = sorted((luminance(colours[ink]), luminance(colours[ground])), reverse=True)
            assert (light + 0.05) / (dark + 0.05) >= CONTRAST, (ink, ground)
