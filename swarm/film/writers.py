"""Pictures to a file: MP4 by ffmpeg or OpenCV, GIF by Pillow."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from swarm.errors import RunFailedError, UserError
from swarm.files import printable, write_whole

Pictures: TypeAlias = Iterator[NDArray[np.uint8]]
"""Each (rows, columns, red green blue)."""

CODES = ("vp09", "mp4v")
"""What OpenCV's own ffmpeg writes into MP4: VP9, which browsers show, and where it is missing MPEG-4."""
GIF_FRAMES_PER_S = 10
"""Of a GIF, which stores whole pictures: enough to follow a robot."""
GIF_WIDTH = 800
GIF_COLOURS = 128
FORMS = (".mp4", ".gif")


def check_form(out: Path) -> None:
    """UserError for a name of another form."""
    if out.suffix not in FORMS:
        raise UserError(f"{printable(out)}: films are written as {' or '.join(FORMS)}, by the name's ending")


def write_film(out: Path, frames_per_s: int, size: tuple[int, int], pictures: Pictures) -> None:
    """A film of (width, height), whole or not at all."""
    check_form(out)

    def write(temporary: Path) -> None:
        if out.suffix == ".gif":
            _write_gif(temporary, frames_per_s, pictures)
        elif shutil.which("ffmpeg"):
            _write_by_ffmpeg(temporary, frames_per_s, size, pictures)
        else:
            _write_by_opencv(temporary, frames_per_s, size, pictures)

    write_whole(out, write)


def _write_gif(file: Path, frames_per_s: int, pictures: Pictures) -> None:
    """Every so manieth picture, smaller."""
    step = max(1, round(frames_per_s / GIF_FRAMES_PER_S))
    chosen = (picture for number, picture in enumerate(pictures) if number % step == 0)
    first, *others = (_small(picture) for picture in chosen)
    shown_ms = round(1000 * step / frames_per_s)
    first.save(file, format="GIF", save_all=True, append_images=others, duration=shown_ms, loop=0)


def _small(picture: NDArray[np.uint8]) -> Image.Image:
    height = round(picture.shape[0] * GIF_WIDTH / picture.shape[1])
    small = cv2.resize(picture, (GIF_WIDTH, height), interpolation=cv2.INTER_AREA)
    return Image.fromarray(small).quantize(GIF_COLOURS, dither=Image.Dither.NONE)


def _write_by_opencv(file: Path, frames_per_s: int, size: tuple[int, int], pictures: Pictures) -> None:
    """OpenCV knows the form by the name's ending."""
    named = file.with_name(f"{file.name}.mp4")
    writer = _opened(named, frames_per_s, size)
    try:
        for picture in pictures:
            writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
        writer.release()
        named.replace(file)
    finally:
        writer.release()
        named.unlink(missing_ok=True)


def _opened(file: Path, frames_per_s: int, size: tuple[int, int]) -> Any:
    for code in CODES:
        writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*code), frames_per_s, size)
        if writer.isOpened():
            return writer
    raise RunFailedError("this OpenCV writes no MP4: install ffmpeg, or name a film that ends in .gif")


def _write_by_ffmpeg(file: Path, frames_per_s: int, size: tuple[int, int], pictures: Pictures) -> None:
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", str(frames_per_s))
    coded = ("-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4")
    command = ("ffmpeg", "-loglevel", "error", "-y", *raw, "-i", "-", *coded, str(file))
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        assert ffmpeg.stdin
        assert ffmpeg.stderr
        try:
            for picture in pictures:
                ffmpeg.stdin.write(picture.tobytes())
            ffmpeg.stdin.close()
        except BrokenPipeError:
            pass
        said = ffmpeg.stderr.read().decode(errors="replace").strip()
    if ffmpeg.returncode:
        raise RunFailedError(f"ffmpeg could not write {printable(file)}: {said or ffmpeg.returncode}")
