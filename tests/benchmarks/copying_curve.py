"""The published copying curve: `python -m tests.benchmarks.copying_curve` writes it into docs/.

Both profiles, random and expert demonstrations, against the range noise k and the frame rate.
"""

from __future__ import annotations

import argparse
import csv
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from swarm.config.experiment import CopyProfile
from tests.benchmarks.copying import CHOOSE_MOVES, demonstrations, score
from tests.support.demonstrations import Conditions

NOISE_PER_CM = (0.0, 6.7e-5, 1.5e-4, 3e-4, 4.9e-4, 6e-4)
FRAMES_HZ = (2.0, 5.0, 10.0)
COLUMNS = (
    "profile", "kind", "frames_hz", "k_per_cm", "demonstrations",
    "perfect", "perfect_ci95", "edit_mean", "not_copied",
)  # fmt: skip

Row = dict[str, Any]


def rows(count: int, seed: int) -> list[Row]:
    """One row for each profile, kind of demonstration, frame rate and noise."""
    table: list[Row] = []
    for kind in CHOOSE_MOVES:
        for frames_hz in FRAMES_HZ:
            for k_per_cm in NOISE_PER_CM:
                conditions = Conditions(range_noise_per_m=100 * k_per_cm, frames_hz=frames_hz)
                shown = demonstrations(kind, conditions, count, seed)
                place = {"kind": kind, "frames_hz": frames_hz, "k_per_cm": k_per_cm}
                table += [{"profile": str(p), **place, **asdict(score(shown, p))} for p in CopyProfile]
    return table


def write_csv(table: list[Row], path: Path) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


def draw(table: list[Row], path: Path) -> None:
    """Above the share of perfect lists, below the mean edit distance; one column for each kind."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 7.5), layout="constrained")
    axes = figure.subplots(2, len(CHOOSE_MOVES), sharex=True, sharey="row")
    for column, kind in enumerate(CHOOSE_MOVES):
        chosen = [row for row in table if row["kind"] == kind]
        _draw_lines(axes[0, column], chosen, "perfect", "perfect_ci95")
        _draw_lines(axes[1, column], chosen, "edit_mean", None)
        axes[0, column].set(title=f"{kind} demonstrations of five moves", ylim=(0, 1.02))
        axes[1, column].set(xlabel="range noise k, 1e-4 per cm (s.d. of the range is k d²)")
        axes[1, column].set_yscale("symlog", linthresh=0.1)
    axes[0, 0].set_ylabel("perfect lists (95 % interval)")
    axes[1, 0].set_ylabel("mean edit distance, moves")
    axes[0, 0].legend(fontsize="small")
    figure.savefig(path, dpi=110, metadata={"Software": None})


def _draw_lines(axes: Any, table: list[Row], value: str, interval: str | None) -> None:
    styles = {"best": "-", "paper": "--"}
    for profile, style in styles.items():
        for colour, frames_hz in enumerate(FRAMES_HZ):
            points = [row for row in table if (row["profile"], row["frames_hz"]) == (profile, frames_hz)]
            axes.errorbar(
                [1e4 * row["k_per_cm"] for row in points],
                [row[value] for row in points],
                yerr=[row[interval] for row in points] if interval else None,
                linestyle=style,
                marker=".",
                color=f"C{colour}",
                label=f"{profile}, {frames_hz:g} frames/s",
            )
    axes.grid(alpha=0.3)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("docs"))
    arguments = parser.parse_args()
    table = rows(arguments.demonstrations, arguments.seed)
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_csv(table, arguments.out / "copying-curve.csv")
    draw(table, arguments.out / "copying-curve.png")
    print(json.dumps({"benchmark": "copying_curve", "rows": len(table), "out": str(arguments.out)}))


if __name__ == "__main__":
    main()
