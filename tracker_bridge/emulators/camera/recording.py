"""What an emulated camera leaves behind: pictures or a video, and the truth beside them."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from swarm.files import new_folder

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

TRUTH_COLUMNS = ("frame", "t_s", "robot", "x_m", "y_m", "theta_rad")


class PictureRecorder:
    """Writes grey frames into a new folder, as PNG pictures or as one video, and `truth.csv`."""

    def __init__(self, folder: Path, robots: Sequence[str], frames_per_s: float, as_video: bool) -> None:
        self._folder, self._robots, self._frames_per_s = folder, robots, frames_per_s
        self._as_video = as_video
        self._video: cv2.VideoWriter | None = None
        self._frame = 0
        new_folder(folder)
        if not as_video:
            (folder / "frames").mkdir()
        self._file = (folder / "truth.csv").open("w", newline="")
        self._truth = csv.writer(self._file)
        self._truth.writerow(TRUTH_COLUMNS)

    @property
    def source(self) -> str:
        """The pictures, from the folder's place."""
        return "video.avi" if self._as_video else "frames"

    def write(self, picture: Grey, poses: Floats) -> None:
        """One frame and the robots' poses (n, 3) in the middle of its exposure."""
        if self._as_video:
            self._to_video(picture)
        else:
            cv2.imwrite(str(self._folder / "frames" / f"{self._frame:06}.png"), picture)
        t_s = self._frame / self._frames_per_s
        for robot, pose in zip(self._robots, poses, strict=True):
            self._truth.writerow([self._frame, f"{t_s:.6f}", robot, *(f"{part:.6f}" for part in pose)])
        self._frame += 1

    def close(self) -> None:
        self._file.close()
        if self._video is not None:
            self._video.release()

    def _to_video(self, picture: Grey) -> None:
        if self._video is None:
            code = cv2.VideoWriter.fourcc(*"MJPG")
            size = (picture.shape[1], picture.shape[0])
            name = str(self._folder / self.source)
            self._video = cv2.VideoWriter(name, code, self._frames_per_s, size, isColor=False)
        self._video.write(picture)


@dataclass(frozen=True)
class RecordedSwarm:
    """Poses from a file with the columns t_s, robot, x_m, y_m, theta_rad, such as a `truth.csv`."""

    robots: tuple[str, ...]
    times_s: tuple[Floats, ...]
    poses: tuple[Floats, ...]
    """For each robot (n, 3), headings unwrapped."""

    @classmethod
    def load(cls, path: Path) -> RecordedSwarm:
        """UserError for a file that does not have these columns, or numbers in them."""
        rows: dict[str, list[tuple[float, ...]]] = {}
        try:
            with path.open(newline="") as file:
                for row in csv.DictReader(file):
                    parts = (float(row[name]) for name in ("t_s", "x_m", "y_m", "theta_rad"))
                    rows.setdefault(row["robot"], []).append(tuple(parts))
        except (OSError, KeyError, TypeError, ValueError) as error:
            raise UserError(
                f"{path}: not a file of poses ({error}); wanted: {', '.join(TRUTH_COLUMNS)}"
            ) from error
        if not rows:
            raise UserError(f"{path}: no poses in it")
        tables = [np.array(sorted(table)) for table in rows.values()]
        for table in tables:
            table[:, 3] = np.unwrap(table[:, 3])
        return cls(tuple(rows), tuple(each[:, 0] for each in tables), tuple(each[:, 1:] for each in tables))

    def at(self, t_s: float, step_s: float) -> tuple[Floats, Floats]:
        """Poses and velocities (n, 3) at a time, from straight lines between the recorded poses."""
        before, now, after = (self._poses_at(t_s + part * step_s / 2) for part in (-1, 0, 1))
        return now, (after - before) / step_s

    def frames(self, frames_per_s: float, seconds: float) -> Iterator[tuple[Floats, Floats]]:
        """Poses and velocities at each frame of the recording, or of its beginning."""
        first_s, last_s = min(times[0] for times in self.times_s), max(times[-1] for times in self.times_s)
        count = math.floor(min(seconds, last_s - first_s) * frames_per_s) + 1
        for number in range(count):
            yield self.at(first_s + number / frames_per_s, 1 / frames_per_s)

    def _poses_at(self, t_s: float) -> Floats:
        robots = zip(self.times_s, self.poses, strict=True)
        return np.array(
            [[np.interp(t_s, times, poses[:, part]) for part in range(3)] for times, poses in robots]
        )
