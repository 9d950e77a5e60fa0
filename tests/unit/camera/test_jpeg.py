"""JPEGs stay within their bytes, whatever the picture is."""

import numpy as np
import pytest
from numpy.typing import NDArray

from giraff_camera.device.image import cv2
from giraff_camera.jpeg import JpegEncoder, half

LIMITS = (1000, 4000, 8000, 40_000, 60_000)
NOISE = np.random.default_rng(1).integers(0, 256, (240, 320, 3), np.uint8)
FLAT = np.full((240, 320), 130, np.uint8)


def decoded(jpeg: bytes) -> NDArray[np.uint8]:
    pixels = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_UNCHANGED)
    assert pixels is not None
    return np.asarray(pixels, np.uint8)


@pytest.mark.parametrize("pixels", [NOISE, half(NOISE), NOISE[..., 0], FLAT], ids=["noise", "small", "grey", "flat"])
def test_no_picture_is_larger_than_it_may_be(pixels: NDArray[np.uint8]) -> None:
    encoder = JpegEncoder(95)
    for limit in (*LIMITS, *reversed(LIMITS)):
        jpeg = encoder.encode(pixels, limit)
        assert len(jpeg) <= limit
        assert decoded(jpeg).shape[:2] == encoder.size[::-1]


def test_the_largest_picture_of_a_robot_file_fits_into_the_fewest_bytes() -> None:
    pixels = np.random.default_rng(2).integers(0, 256, (1080, 1920, 3), np.uint8)
    encoder = JpegEncoder(95)
    assert len(encoder.encode(pixels, 1000)) <= 1000
    assert encoder.size == (60, 33)


def test_what_fitted_last_is_tried_first_and_the_quality_comes_back_slowly() -> None:
    encoder = JpegEncoder(80)
    encoder.encode(NOISE, 8000)
    tries = []
    for _ in range(20):
        encoder.encode(NOISE, 8000)
        tries.append(encoder.tries)
    assert max(tries) <= 2
    assert encoder.size == (320, 240)
    encoder.encode(FLAT, 8000)
    lengths = [len(encoder.encode(NOISE[:120, :160], 60_000)) for _ in range(12)]
    assert lengths == sorted(lengths)
    assert lengths[0] < lengths[5] < lengths[-1] == len(JpegEncoder(80).encode(NOISE[:120, :160], 60_000))


def test_bytes_for_which_there_is_no_picture_are_refused() -> None:
    with pytest.raises(ValueError, match="at most 100 bytes"):
        JpegEncoder(80).encode(NOISE, 100)


def test_half_a_picture_has_a_quarter_of_the_pixels() -> None:
    assert half(NOISE).shape == (120, 160, 3)
    assert half(FLAT[:1, :1]).shape == (1, 1)
