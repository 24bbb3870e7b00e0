"""The sensor's chain and the lens against closed forms: gains, noise, blur, packing."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.support.judge.optics import Camera, Lens
from tests.support.judge.sensor import ADC_MAXIMUM, Sensor, mosaic, rgb565, yuyv

QUIET = Sensor(noise=0.0)


def test_gains_set_the_ratio_of_the_channels() -> None:
    light = np.full((16, 16, 3), 0.3, np.float32)
    sensor = replace(QUIET, gains=(1.35, 1.0, 0.65))
    developed = sensor.developed(light, np.random.default_rng(0))[8, 8] / 255.0
    red, green, blue = developed**sensor.gamma
    assert red / green == pytest.approx(1.35, rel=0.02)
    assert blue / green == pytest.approx(0.65, rel=0.02)


@pytest.mark.parametrize("exposure", [0.3, 0.5, 1.5])
def test_exposure_multiplies_and_saturates(exposure: float) -> None:
    light = np.linspace(0, 1, 64, dtype=np.float32)[None, :, None] * np.ones((16, 1, 3), np.float32)
    developed = replace(QUIET, exposure=exposure).developed(light, np.random.default_rng(0))
    expected = np.clip(exposure * light[8, 2:-2, 1], 0, 1)
    assert (developed[8, 2:-2, 1] / 255.0) ** 2.2 == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("noise", [1.0, 3.0])
@pytest.mark.parametrize("signal", [0.1, 0.5])
def test_noise_has_the_variance_of_electrons_and_reading(noise: float, signal: float) -> None:
    sensor = Sensor(noise=noise)
    counts = sensor.converted(np.full((400, 400), signal, np.float32), np.random.default_rng(7))
    expected = noise**2 * (signal / sensor.full_well + (sensor.read_noise / sensor.full_well) ** 2)
    quantisation = 1 / 12 / ADC_MAXIMUM**2
    assert np.var(counts / ADC_MAXIMUM) == pytest.approx(expected + quantisation, rel=0.02)
    assert np.mean(counts / ADC_MAXIMUM) == pytest.approx(signal, abs=1e-3)


def test_the_mosaic_passes_red_green_green_blue() -> None:
    light = np.arange(12, dtype=np.float32).reshape(2, 2, 3)
    assert mosaic(light).tolist() == [[0.0, 4.0], [7.0, 11.0]]


def test_demosaicing_keeps_the_colour_of_a_flat_patch() -> None:
    light = np.tile(np.array([0.6, 0.3, 0.1], np.float32), (16, 16, 1))
    developed = QUIET.developed(light, np.random.default_rng(0))[4:-4, 4:-4]
    assert np.ptp(developed, axis=(0, 1)).tolist() == [0, 0, 0]
    assert (developed[0, 0] / 255.0) ** 2.2 == pytest.approx([0.6, 0.3, 0.1], rel=0.02)


def test_rgb565_has_the_high_byte_first() -> None:
    colours = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [8, 4, 8]]], np.uint8)
    assert rgb565(colours).hex(" ", 2) == "f800 07e0 001f 0821"


def test_yuyv_has_the_levels_of_the_standard() -> None:
    red = np.tile(np.array([255, 0, 0], np.uint8), (2, 2, 1))
    assert list(yuyv(red)[:4]) == pytest.approx([81, 90, 81, 240], abs=1)  # BT.601, table of primaries
    grey = np.full((2, 2, 3), 128, np.uint8)
    assert list(yuyv(grey)[:4]) == pytest.approx([126, 128, 126, 128], abs=1)


def test_yuyv_survives_an_ordinary_decoder() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (32, 32, 3), np.uint8)
    smooth = np.asarray(cv2.GaussianBlur(noise, (0, 0), 6), np.uint8)
    packed = np.frombuffer(yuyv(smooth), np.uint8).reshape(32, 32, 2)
    decoded = cv2.cvtColor(packed, cv2.COLOR_YUV2RGB_YUYV)
    assert np.abs(decoded.astype(int) - smooth).max() <= 8


def test_the_lens_blurs_by_its_standard_deviation_and_darkens_the_corners() -> None:
    camera = Camera(65, 65, 0.84, 0.028, 0.03, lens=Lens(blur_px=2.0, vignetting=0.0))
    impulse = np.zeros((65, 65, 3), np.float32)
    impulse[32, 32] = 1.0
    spread = camera.expose(impulse)[..., 0].sum(axis=0)
    assert np.sum(spread * (np.arange(65) - 32.0) ** 2) == pytest.approx(4.0, rel=0.05)
    dark = replace(camera, lens=Lens(vignetting=0.4)).expose(np.ones((65, 65, 3), np.float32))
    assert dark[32, 32, 0] == pytest.approx(1.0)
    assert dark[0, 0, 0] == pytest.approx(0.6, abs=0.02)


def test_the_same_seed_gives_the_same_frame() -> None:
    light = np.full((12, 16, 3), 0.3, np.float32)
    first, again, other = (Sensor().read(light, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert first == again != other
    assert len(first) == 16 * 12 * 2
