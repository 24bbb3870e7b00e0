"""The store of true and copied lists, and copies drawn from it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from swarm.errors import UserError
from swarm.geometry import Move
from swarm.surrogate.copies import CopyPair, CopyStore, load_copies, repeated_errors, turns_of, write_copies

E, SE, S, SW, W, NW, N, NE = Move


def pair(true: tuple[Move, ...], copied: tuple[Move, ...], kind: str = "random") -> CopyPair:
    return CopyPair(kind, true, copied)


@pytest.mark.parametrize(
    ("true", "copied", "turns"),
    [
        ((E, S, W), (E, S, W), [[0], [0], [0]]),
        ((E, S, W), (E, W), [[0], [], [0]]),
        ((E, S, W), (E, SE, W), [[0], [7], [0]]),
        ((E, S, W), (E, S, S, W), [[0], [0, 0], [0]]),
        ((E, S, W), (NE, E, S, W), [[7, 0], [0], [0]]),
        ((E, S, W), (), [[], [], []]),
    ],
)
def test_errors_are_found_by_place(
    true: tuple[Move, ...], copied: tuple[Move, ...], turns: list[list[int]]
) -> None:
    found = turns_of(pair(true, copied))
    assert found == turns or sum(map(len, found)) == sum(map(len, turns))
    assert repeated_errors(pair(true, copied), true) == copied


@pytest.mark.parametrize("seed", range(30))
def test_the_errors_of_a_pair_made_again_on_its_own_list_give_its_copy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    true = tuple(Move(int(move)) for move in rng.integers(8, size=5))
    copied = tuple(Move(int(move)) for move in rng.integers(8, size=int(rng.integers(1, 8))))
    assert repeated_errors(pair(true, copied), true) == copied


def test_errors_carry_over_to_another_list() -> None:
    lost_second = pair((E, S, W, N, E), (E, W, N, E))
    assert repeated_errors(lost_second, (SE,) * 5) == (SE,) * 4
    turned_first = pair((E, S, W, N, E), (SE, S, W, N, E))
    assert repeated_errors(turned_first, (S, S, S, S, S)) == (SW, S, S, S, S)
    assert repeated_errors(turned_first, (S, N)) == (SW, N), "a shorter list"
    assert repeated_errors(pair((E,) * 5, ()), (S,) * 5) == (), "refused"


def test_copies_of_the_very_same_list_are_preferred() -> None:
    expert = (SE,) * 5
    wrong = pair(expert, (SE,) * 4, "expert")
    store = CopyStore((*[pair(expert, expert, "expert")] * 15, *[wrong] * 5, pair((E,) * 5, (), "random")))
    rng = np.random.default_rng(1)
    drawn = Counter(len(store.drawn(expert, rng)) for _ in range(2000))
    assert set(drawn) == {4, 5}
    assert drawn[4] / 2000 == pytest.approx(0.25, abs=0.03)
    assert store.drawn((S,) * 5, rng) == (), "another list is drawn from the random ones"


def test_a_store_is_read_as_it_was_written(tmp_path: Path) -> None:
    pairs = (pair((E, S), (E,)), pair((N, NW), (), "expert"))
    write_copies(pairs, tmp_path / "copies.csv", ["how it was made"])
    assert load_copies(tmp_path / "copies.csv").pairs == pairs
    assert (tmp_path / "copies.csv").read_text().startswith("# how it was made\nkind,true,copied\n")


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "copies.csv").write_text("mine")
    with pytest.raises(UserError, match="is there already"):
        write_copies([], tmp_path / "copies.csv", [])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "each row must have"),
        ("kind,true\nrandom,E\n", "each row must have"),
        ("kind,true,copied\nrandom,E,E,E\n", "each row must have"),
        ("kind,true,copied\nrandom,E X,E\n", "no compass move"),
        ("kind,true,copied\nrandom,E,E\nrandom,E S,E\n", "true lists of one length"),
        ("kind,true,copied\nrandom,,E\n", "true lists of one length"),
        ("kind,true,copied\nexpert,E,E\n", "pairs of the kind 'random'"),
        ("kind,true,copied\n", "pairs of the kind 'random'"),
    ],
)
def test_a_bad_store_is_refused_with_its_name(text: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(UserError, match=reason) as error:
        load_copies(tmp_path / "bad.csv")
    assert "bad.csv" in str(error.value)


def test_a_missing_store_says_how_to_make_it(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="collect-copies"):
        load_copies(tmp_path / "none.csv")
