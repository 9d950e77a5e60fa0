"""Pictures that others made, before the decoders of the camera, of vision and of the calibration."""

import random
import resource
import struct
import zlib
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final
from unittest.mock import MagicMock

import numpy as np
import pytest
from numpy.typing import NDArray

from giraff_camera.device.image import DeviceError, cv2
from giraff_camera.device.v4l2 import V4l2Camera
from giraff_core.picture.header import HeaderError, read_jpeg
from giraff_core.senses import Camera
from giraff_setup.camera.picture import UnusableError, decode
from giraff_vision.policy import grey_of
from tests.support.jpegs import END, FRAMES, before_tables, bomb, frame, jpeg_of, segment

WIDTH, HEIGHT = 160, 120
Pixels = NDArray[np.uint8]
Door = Callable[[bytes], Pixels]
_SEED: Final = np.asarray(
    cv2.resize(np.random.default_rng(1).integers(0, 256, (6, 8, 3), np.uint8), (WIDTH, HEIGHT)), np.uint8
)
JPEG: Final = jpeg_of(_SEED)
EXIF: Final = segment(0xE1, b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0")
"""The picture is to be shown turned by 180°."""
NOISY: Final = JPEG[:-2] + bytes(20) + END


def by_vision(data: bytes) -> Pixels:
    return grey_of(data, Camera(z=1.0, width=WIDTH, height=HEIGHT))


def by_calibration(data: bytes) -> Pixels:
    return decode(data, WIDTH, HEIGHT)


def camera_of(*pictures: bytes) -> V4l2Camera:
    """Return an open camera that sends these."""
    driver: Any = MagicMock()
    driver.get.return_value = -1.0
    driver.retrieve.side_effect = [(True, np.frombuffer(each, np.uint8)[np.newaxis]) for each in pictures]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cv2, "VideoCapture", lambda *_: driver)
        return V4l2Camera("/dev/video7", WIDTH, HEIGHT, 15.0)


def by_camera(data: bytes) -> Pixels:
    return camera_of(*[data] * 10).read().pixels


DOORS: Final = {"vision": by_vision, "calibration": by_calibration, "camera": by_camera}
every_door = pytest.mark.parametrize("door", DOORS.values(), ids=DOORS)
Refused = (ValueError, UnusableError, DeviceError)


def png_bomb() -> bytes:
    chunks = ((b"IHDR", struct.pack(">II5B", 32_000, 32_000, 8, 0, 0, 0, 0)), (b"IDAT", zlib.compress(b"")))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)) for name, body in chunks
    )


def scans_bomb() -> bytes:
    """Return a picture of this size and 80 kB, whose 5000 scans each cost a pass over it."""
    jpeg = jpeg_of(np.full((HEIGHT, WIDTH), 100, np.uint8), "progressive")
    last = jpeg[jpeg.rindex(b"\xff\xda") : -2]
    return jpeg[:-2] + last * 5000 + END


BOMBS: Final = {kind: bomb(kind) for kind in FRAMES} | {"PNG": png_bomb(), "scans": scans_bomb()}
OTHERS: Final = {each: cv2.imencode(each, _SEED)[1].tobytes() for each in (".bmp", ".tiff", ".webp", ".jp2")}


@every_door
@pytest.mark.parametrize("data", (BOMBS | OTHERS).values(), ids=BOMBS | OTHERS)
def test_what_takes_much_or_is_of_another_form_never_reaches_the_decoder(
    door: Door, data: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cv2, "imdecode", MagicMock(side_effect=AssertionError("the decoder was asked")))
    with pytest.raises(Refused):
        door(data)


@every_door
def test_a_few_hundred_bytes_take_no_memory(door: Door) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(Refused, match="32000 x 32000"):
        door(bomb("progressive"))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # kB


@every_door
@pytest.mark.parametrize(
    "data",
    [
        before_tables(JPEG, EXIF),
        JPEG + b"\xff",
        JPEG + b"\r\n",
        JPEG + bytes(40),
        JPEG + jpeg_of(np.zeros((8, 8), np.uint8)),
        before_tables(JPEG, segment(0xE1, b"Exif\0\0" + bomb("baseline"))),
        before_tables(JPEG, b"\xff\xff\xff"),
        NOISY,
    ],
    ids=["orientation", "0xff", "newline", "zeros", "a second picture", "thumbnail", "fill", "extraneous"],
)
def test_a_whole_picture_is_as_the_sensor_saw_it_and_its_decoder_prints_nothing(
    door: Door, data: bytes, capfd: pytest.CaptureFixture[str]
) -> None:
    assert np.array_equal(door(data), door(JPEG))
    if door is not by_vision:  # its pictures come from giraff_camera's encoder
        assert capfd.readouterr().err == ""


@pytest.mark.parametrize("lines", [HEIGHT, HEIGHT - 3])
def test_a_picture_that_lacks_only_its_end_marker_is_whole(lines: int) -> None:
    unended = jpeg_of(_SEED[:lines])[:-2]
    assert np.array_equal(decode(unended, WIDTH, lines), decode(unended + END, WIDTH, lines))
    camera = camera_of(JPEG[:-2], JPEG[:-2] + bytes(40), JPEG)
    first, second, whole = (camera.read().pixels for _ in range(3))
    assert np.array_equal(first, whole)
    assert np.array_equal(second, whole)


@every_door
def test_a_torn_picture_is_refused_unless_it_lacks_its_last_corner_alone(door: Door) -> None:
    whole, begin = by_calibration(JPEG), JPEG.index(b"\xff\xda") + 20
    for cut in range(begin, len(JPEG) - 300, 50):
        with pytest.raises(Refused, match="torn"):
            door(JPEG[:cut])
    if door is by_calibration:
        shown = 0
        for cut in range(len(JPEG) - 300, len(JPEG) - 2):
            with suppress(UnusableError):
                assert np.count_nonzero(door(JPEG[:cut]) != whole) <= 16 * 16
                shown += 1
        assert shown > 0


def test_a_camera_that_has_sent_an_end_marker_is_held_to_it() -> None:
    camera = camera_of(JPEG, JPEG[:-2], JPEG)
    assert np.array_equal(camera.read().pixels, camera.read().pixels)
    with pytest.raises(StopIteration):
        camera.read()


@pytest.mark.parametrize(("form", "is_raw"), [("MJPG", True), ("JPEG", True), ("YUYV", False)])
def test_opencv_is_given_no_jpeg_to_decode_by_itself(form: str, is_raw: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    driver = MagicMock()
    driver.get.side_effect = lambda name: float(cv2.VideoWriter.fourcc(*form)) if name == cv2.CAP_PROP_FOURCC else -1.0
    monkeypatch.setattr(cv2, "VideoCapture", lambda *_: driver)
    V4l2Camera("/dev/video7", WIDTH, HEIGHT, 15.0)
    assert (((cv2.CAP_PROP_CONVERT_RGB, 0),) in driver.set.call_args_list) == is_raw


def test_whatever_is_decoded_has_the_size_that_its_header_says() -> None:
    """Headers with bytes changed, put in and left out."""
    noise = random.Random(1)
    jpeg = jpeg_of(_SEED[:16, :24])
    begins, decoded = [0xC0, 0xC2, 0xC4, 0xD8, 0xD9, 0xDA, 0xDC, 0xE1, 0xFF], 0
    for _ in range(3000):
        at = noise.randrange(jpeg.index(b"\xff\xda") + 20)
        put = noise.choice((b"", noise.randbytes(2), bytes([0xFF, noise.choice(begins)]), frame(0xC0, 40, 40)))
        data = jpeg[:at] + put + jpeg[at + noise.choice((0, len(put))) :]
        try:
            header = read_jpeg(data)
        except HeaderError:
            continue
        if header.fits(400, 400):
            pixels = cv2.imdecode(np.frombuffer(header.data, np.uint8), cv2.IMREAD_UNCHANGED)
            if pixels is not None:
                decoded += 1
                assert pixels.shape[1::-1] == (header.width, header.height), data.hex()
    assert decoded > 300
