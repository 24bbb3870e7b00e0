"""A generator of experiment files and command lines of which each has something wrong."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import strategies as st

GOOD_FILE = """[run]
name = "good"
moves = 20
trials = 1
seed = 3

[arena]
width_m = 3.0
cell_m = 0.12
columns = 10

[learning]
epsilon = 0.1
approach = "average_q"
capacity = 10

[visits]
duration_s = 30.0
profile = "best"

[camera]
conditions = "clean"

[[robot]]
id = "teacher"
role = "expert"
skirt = "green"
south_west_m = [0.0, 0.3]

[[robot]]
id = "pupil"
watches = "teacher"
driver = "sim"
south_west_m = [1.5, 0.3]
paths = [["SE", "E"], ["S"]]
"""
LINES = GOOD_FILE.splitlines()
KEYS = [number for number, line in enumerate(LINES) if "=" in line]
BAD_VALUES = (
    *(
        "",
        "[",
        "[" * 3000,
        "{",
        "}",
        "'",
        '"',
        '"""',
        "1 2",
        "= 3",
        "\x00",
        "\x07",
        "0x",
        "1e",
        "--1",
        "1979-13-01",
    ),
    *(
        "nan",
        "inf",
        "-inf",
        "-1",
        "1e400",
        "-0.5",
        "9" * 400,
        "99999999999999999999",
        "2e9",
        "true",
        "1979-05-27",
    ),
    *(
        '"zz"',
        '"../x"',
        '"\\ud800"',
        '"' + "y" * 3000 + '"',
        '"ä"',
        '"-rf"',
        "[]",
        "[1]",
        "[[]]",
        "{ a = 1 }",
    ),
)


@st.composite
def _bad_value(draw: st.DrawFn) -> str:
    number = draw(st.sampled_from(KEYS))
    key = LINES[number].split(" = ")[0]
    return _with(number, f"{key} = {draw(st.sampled_from(BAD_VALUES))}")


@st.composite
def _bad_key(draw: st.DrawFn) -> str:
    number = draw(st.sampled_from(KEYS))
    key, value = LINES[number].split(" = ", 1)
    letters = draw(st.text("abcdefgxyz_-", min_size=1, max_size=5))
    return _with(number, f"{key}{letters} = {value}")


@st.composite
def _bad_line(draw: st.DrawFn) -> str:
    number = draw(st.integers(0, len(LINES) - 1))
    return _with(
        number, draw(st.sampled_from(("[", "]", "[[robots]]", "[robot]", "[x]", "= 3", "a.b.c = 1", "\x01")))
    )


@st.composite
def _twice(draw: st.DrawFn) -> str:
    number = draw(st.sampled_from(KEYS))
    return _with(number, f"{LINES[number]}\n{LINES[number]}")


@st.composite
def _cut(draw: st.DrawFn) -> str:
    return GOOD_FILE[: draw(st.integers(0, len(GOOD_FILE) - 120))]


def _with(number: int, line: str) -> str:
    return "\n".join([*LINES[:number], line, *LINES[number + 1 :], ""])


def experiment_files() -> st.SearchStrategy[bytes]:
    """Files that are wrong, nearly all of them: a cut or another value may leave a good one."""
    texts = st.one_of(_bad_value(), _bad_key(), _bad_line(), _twice(), _cut(), st.text(max_size=80))
    files = texts.map(lambda text: text.encode("utf-8", "surrogatepass"))
    return st.one_of(files, files, files, st.binary(max_size=60))


@dataclass(frozen=True)
class Command:
    """A module and its words; EXPERIMENT stands for a good file."""

    module: str
    words: tuple[str, ...]


EXPERIMENT = "{experiment}"
SERVER = ("--moves", "--seed", "--processes", "--speed=0", "--trial", "--out=-rf", "--out=")
AGENT = (
    "--moves",
    "--seed",
    "--speed=0",
    "--trial",
    "--state=-rf",
    "--robot=nobody",
    "--robot=",
    "--robot=pupil,pupils",
)
COMMANDS: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...] = (
    ("swarm", ("simulate", EXPERIMENT), ("--moves", "--seed", "--processes", "--speed=0", "--out=-rf")),
    ("server", (EXPERIMENT,), SERVER),
    ("robot_agent", (EXPERIMENT, "--robot=pupil"), AGENT),
    ("tracker_bridge", (EXPERIMENT,), ("--moves", "--seed", "--speed=0", "--trial")),
    ("swarm", ("trials", EXPERIMENT), ("--trials", "--moves", "--seed", "--jobs", "--out=-rf")),
    (
        "swarm",
        ("reproduce", "fig3"),
        ("--seed", "--jobs", "--out=-rf", "--scheduler=cron"),
    ),
    ("swarm", ("doctor", EXPERIMENT), ("--out=-rf",)),
    ("swarm", ("analyze", "no-such-run"), ("--out=-rf",)),
    ("swarm", ("check", "no-such-log.mcap"), ()),
    ("swarm", ("recover", "no-such-log.mcap"), ("--out=-rf",)),
    ("swarm", ("durations", "no-such-run"), ("--out=-rf",)),
    (
        "robot_agent",
        ("calibrate", "--camera=no-such-file", "--skirt=red", "--simulated", "--out=x.npz"),
        ("--seed",),
    ),
)
"""A module, a command line without options, and options that need a value or are wrong as they stand."""
NO_NUMBERS = ("abc", "-1", "1e3", "1.5", "", "nan", "9" * 30, "0x10", "'", "\udcff", "--")


@st.composite
def command_lines(draw: st.DrawFn) -> Command:
    """One good command line with one thing that is wrong."""
    module, words, options = draw(st.sampled_from(COMMANDS))
    option = draw(st.sampled_from((*options, "--no-such-option", "one-more-word")))
    value = (
        ""
        if "=" in option or not option.startswith("--") or option not in options
        else draw(st.sampled_from(NO_NUMBERS))
    )
    wrong = f"{option}={value}" if option in options and "=" not in option else option
    return Command(module, (*words, wrong))
