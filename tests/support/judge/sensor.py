"""From light on the sensor to the bytes of a frame: exposure, mosaic, noise, gamma, quantisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.support.judge.scene import Image

PixelFormat = Literal["rgb565", "yuyv"]

ADC_MAXIMUM = 1023  # ten bits, as small CMOS cameras convert


@dataclass(frozen=True)
class Sensor:
    """A CMOS sensor with a Bayer mosaic (red, green; green, blue) and the camera's own processing.

    `gains` are the channels' white balance (red, green, blue): of light or of processing, to the sensor it is
    the same. A pixel holds `full_well` electrons at radiance 1, which noise as their square root, and
    `read_noise` electrons of noise are added; `noise` multiplies both. The well is that of a cheap sensor
    indoors, whose gain leaves a fraction of its pixels' capacity.
    """

    exposure: float = 1.0
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)
    full_well: float = 4000.0
    read_noise: float = 10.0
    noise: float = 1.0
    gamma: float = 2.2
    pixel_format: PixelFormat = "rgb565"

    def read(self, light: Image, generator: np.random.Generator) -> bytes:
        """The frame that light (height, width, 3) leaves."""
        picture = self.developed(light, generator)
        return rgb565(picture) if self.pixel_format == "rgb565" else yuyv(picture)

    def developed(self, light: Image, generator: np.random.Generator) -> NDArray[np.uint8]:
        """The picture (height, width, 3) in eight bits that is then packed."""
        amplification = np.array(self.gains, np.float32) * np.float32(self.exposure)
        raw = self.converted(mosaic(light * amplification), generator)
        linear = cv2.cvtColor(raw, cv2.COLOR_BayerRGGB2RGB)
        curve = 255 * (np.arange(ADC_MAXIMUM + 1) / ADC_MAXIMUM) ** (1 / self.gamma)
        picture: NDArray[np.uint8] = np.rint(curve).astype(np.uint8)[linear]
        return picture

    def converted(self, signal: Image, generator: np.random.Generator) -> NDArray[np.uint16]:
        """Counts of the converter (height, width) for a signal of which 1 fills the wells."""
        shot = np.maximum(signal, 0) / np.float32(self.full_well)
        read = np.float32((self.read_noise / self.full_well) ** 2)
        normal = generator.standard_normal(signal.shape, dtype=np.float32)
        noisy = signal + np.float32(self.noise) * np.sqrt(shot + read) * normal
        counts: NDArray[np.uint16] = np.rint(np.clip(noisy, 0, 1) * ADC_MAXIMUM).astype(np.uint16)
        return counts


def mosaic(light: Image) -> Image:
    """The one colour that each pixel's filter passes (height, width); red at the first pixel."""
    passed = light[..., 1].copy()
    passed[0::2, 0::2] = light[0::2, 0::2, 0]
    passed[1::2, 1::2] = light[1::2, 1::2, 2]
    return passed


def rgb565(picture: NDArray[np.uint8]) -> bytes:
    """Five, six and five bits, high byte first."""
    red, green, blue = (picture[..., channel].astype(np.uint16) for channel in range(3))
    return (red >> 3 << 11 | green >> 2 << 5 | blue >> 3).astype(">u2").tobytes()


def yuyv(picture: NDArray[np.uint8]) -> bytes:
    """ITU-R BT.601 in video range: Y0 U Y1 V for every two pixels."""
    return cv2.cvtColor(picture, cv2.COLOR_RGB2YUV_YUYV).tobytes()
