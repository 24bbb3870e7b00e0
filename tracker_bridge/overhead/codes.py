"""Reading tags: how well the grey values within a quadrilateral agree with each code of a family."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tracker_bridge.overhead.edges import sampled

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

BLUR = 0.25
"""Part of a module's grey that comes from its four neighbours, where a module has 2 to 3 pixels.
Agreement of true tags was flat from 0.2 to 0.3 on rendered frames; that of wrong ones rises slowly."""


class CodeBook:
    """The codes of some tags: (n, modules, modules), 1 for white, black borders included."""

    def __init__(self, codes: Grey) -> None:
        modules = codes.shape[1]
        turned = np.concatenate([np.rot90(codes, turns, (1, 2)) for turns in range(4)])
        expected = _blurred(turned).reshape(len(turned), -1)
        inner = np.zeros((modules, modules), dtype=np.bool_)
        inner[1:-1, 1:-1] = True
        self._inner = inner.ravel()
        self._expected = _unit(expected)
        self._expected_inner = _unit(expected[:, self._inner])
        middles = (np.arange(modules) + 0.5) / modules
        self._across, self._down = (axis.ravel() for axis in np.meshgrid(middles, middles))
        self._count = len(codes)

    def read(
        self, picture: Grey, quads: Floats
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Floats]:
        """For each quad (n, 4, 2), clockwise: which code agrees best, how often its corners must be rolled to
        begin at the tag's upper left, and the agreement."""
        grey = self._grey(picture, quads)
        best = (_unit(grey[:, self._inner]) @ self._expected_inner.T).argmax(1)
        return best % self._count, best // self._count, self._agreement(grey, best)

    def agreement(self, picture: Grey, quads: Floats, numbers: list[int]) -> Floats:
        """(n,): of each quad, which begins at the tag's upper left, with the code of a given number."""
        return self._agreement(self._grey(picture, quads), np.array(numbers))

    def _agreement(self, grey: Floats, numbers: npt.NDArray[np.int64]) -> Floats:
        """The correlation of what is seen with a code, 1 for a perfect print: of the inner modules alone,
        which tell tags apart, or of all with the border, which tells tags from other things, if less."""
        whole = (_unit(grey) * self._expected[numbers]).sum(1)
        inner = (_unit(grey[:, self._inner]) * self._expected_inner[numbers]).sum(1)
        return np.asarray(np.minimum(whole, inner))

    def _grey(self, picture: Grey, quads: Floats) -> Floats:
        return sampled(picture, in_quads(quads, self._across, self._down))


def _blurred(codes: Grey) -> Floats:
    """What a lens makes of codes on white paper."""
    sharp = np.pad(codes.astype(np.float64), ((0, 0), (1, 1), (1, 1)), constant_values=1.0)
    beside = sharp[:, :-2, 1:-1] + sharp[:, 2:, 1:-1] + sharp[:, 1:-1, :-2] + sharp[:, 1:-1, 2:]
    return np.asarray((1 - BLUR) * sharp[:, 1:-1, 1:-1] + BLUR / 4 * beside)


def _unit(rows: Floats) -> Floats:
    """Rows of mean 0 and length 1."""
    rows = rows - rows.mean(1, keepdims=True)
    return np.asarray(rows / (np.linalg.norm(rows, axis=1, keepdims=True) + 1e-9))


def in_quads(quads: Floats, across: Floats, down: Floats) -> Floats:
    """(n, points, 2): places (0..1, 0..1) of a square in the perspective of quads (n, 4, 2).

    Heckbert, Fundamentals of Texture Mapping (1989), section 2.2.3: square to quadrilateral.
    """
    a, b, c, d = (quads[:, number] for number in range(4))
    bend = a - b + c - d
    right, left = b - c, d - c
    area = right[:, 0] * left[:, 1] - left[:, 0] * right[:, 1] + 1e-12
    g = ((bend[:, 0] * left[:, 1] - left[:, 0] * bend[:, 1]) / area)[:, None]
    h = ((right[:, 0] * bend[:, 1] - bend[:, 0] * right[:, 1]) / area)[:, None]
    east, south = b - a + g * b, d - a + h * d
    scale = g * across + h * down + 1
    sheet = east[:, None] * across[:, None] + south[:, None] * down[:, None] + a[:, None]
    return np.asarray(sheet / scale[..., None])
