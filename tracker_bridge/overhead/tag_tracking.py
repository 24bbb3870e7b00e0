"""Tags followed from frame to frame: their edges are looked for where motion says that they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import cycle

import numpy as np
import numpy.typing as npt

from tracker_bridge.overhead.edges import aligned_quads
from tracker_bridge.overhead.search import Window, busy_windows
from tracker_bridge.overhead.tags import Tag, TagDetector

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

REACH_PX = 4.0
"""How far beside its prediction an edge is found: an e-puck that begins to turn at full speed between two of
30 frames/s moves a tag's corner by 3 px where a metre has 390."""
LEAST_AGREEMENT = 0.75
"""To go on with a tag that was read before; another one of 36h11, 11 of 36 bits away, has 0.6 at most."""
LARGEST_STRETCH = 1.35
"""Of a quad's size from one frame to the next: more is the edge of something else."""
NEAR_SIDES = 1.5
"""A tag that was just lost is looked for within so many sides of its place ..."""
NEAR_FRAMES = 5
"""... for so many frames, then anywhere."""
STRIPS = 4
"""A search anywhere takes so many frames, so that one lost tag does not keep the others waiting."""
STRIP_OVERLAP_PX = 100
"""A tag on the border of two strips is whole in one of them; 100 px are 25 cm from 2.5 m."""


@dataclass
class _Followed:
    quad: Floats
    before: Floats | None = None
    missed: int = 0

    def predicted(self) -> Floats:
        """(4, 2): moved and turned on as from the frame before the last to the last."""
        if self.before is None:
            return self.quad
        now, then = self.quad @ [1, 1j], self.before @ [1, 1j]
        turn = ((now - now.mean()) * (then - then.mean()).conj()).sum()
        ahead = 2 * now.mean() - then.mean() + turn / (abs(turn) + 1e-9) * (now - now.mean())
        return np.stack([ahead.real, ahead.imag], 1)


@dataclass
class TagTracker:
    """Follows every tag of a detector's family through the frames of one camera.

    The first frame is searched whole. A tag whose code is no longer read is looked for around its last
    place, then anywhere, one strip of the picture a frame.
    """

    detector: TagDetector
    _followed: dict[int, _Followed] = field(default_factory=dict)
    _strip: Iterator[int] = field(default_factory=lambda: cycle(range(2 * STRIPS)))

    def track(self, picture: Grey) -> list[Tag]:
        """The tags of the next frame, by id."""
        found = self._follow(picture)
        found |= self._search(picture, self._near(picture, found), found)
        found |= self._search(picture, self._far(picture, found), found)
        self._remember(found)
        return [found[tag] for tag in sorted(found)]

    def _follow(self, picture: Grey) -> dict[int, Tag]:
        seen = {tag: each.predicted() for tag, each in self._followed.items() if not each.missed}
        if not seen:
            return {}
        guesses = np.array(list(seen.values()))
        quads = aligned_quads(picture, guesses, REACH_PX, self.detector.family.modules)
        numbers = [self.detector.family.ids.index(tag) for tag in seen]
        agreement = self.detector.book.agreement(picture, quads, numbers)
        kept = np.flatnonzero((agreement > LEAST_AGREEMENT) & _same_size(quads, guesses))
        tags = list(seen)
        return {tags[each]: Tag(tags[each], quads[each], float(agreement[each])) for each in kept}

    def _near(self, picture: Grey, found: dict[int, Tag]) -> list[Window]:
        lost = [
            each for tag, each in self._followed.items() if tag not in found and each.missed < NEAR_FRAMES
        ]
        return [Window.around(each.quad, NEAR_SIDES * _size_px(each.quad), picture) for each in lost]

    def _far(self, picture: Grey, found: dict[int, Tag]) -> list[Window]:
        """The whole picture at first, then a strip at each frame in which a tag is long missing; every second
        time round, all of the strip, whatever its contrast."""
        if not self._followed:
            return [Window(0, 0, picture.shape[1], picture.shape[0])]
        near = {tag for tag, each in self._followed.items() if each.missed < NEAR_FRAMES}
        if found.keys() | near >= set(self.detector.family.ids):
            return []
        height = picture.shape[0] / STRIPS
        is_thorough, number = divmod(next(self._strip), STRIPS)
        top = max(0, int(number * height - STRIP_OVERLAP_PX / 2))
        strip = picture[top : int((number + 1) * height + STRIP_OVERLAP_PX / 2)]
        if is_thorough:
            return [Window(0, top, strip.shape[1], top + strip.shape[0])]
        return [window.lowered(top) for window in busy_windows(strip)]

    def _search(self, picture: Grey, windows: list[Window], found: dict[int, Tag]) -> dict[int, Tag]:
        tags = self.detector.find(picture, windows)  # the surest first, which counts if an id is there twice
        return {tag.id: tag for tag in reversed(tags) if tag.id not in found}

    def _remember(self, found: dict[int, Tag]) -> None:
        for number, each in self._followed.items():
            each.missed += number not in found
        for number, tag in found.items():
            last = self._followed.get(number)
            before = None if last is None or last.missed else last.quad
            self._followed[number] = _Followed(tag.corners, before)


def _size_px(quad: Floats) -> float:
    return float(np.linalg.norm(np.roll(quad, -1, 0) - quad, axis=1).mean())


def _same_size(quads: Floats, guesses: Floats) -> npt.NDArray[np.bool_]:
    """(n,): whether both diagonals of the quads are about as long as those of the guesses."""
    diagonals = [np.linalg.norm(each[:, 2:] - each[:, :2], axis=2) for each in (quads, guesses)]
    ratio = diagonals[0] / diagonals[1]
    return np.asarray(((ratio < LARGEST_STRETCH) & (ratio > 1 / LARGEST_STRETCH)).all(1))
