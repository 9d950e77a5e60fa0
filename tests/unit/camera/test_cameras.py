"""The cameras of the kernel's and the simulated one: what they give, and what is said where they do not."""

import errno
import fcntl
import json
import os
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from giraff_camera.device import opening, v4l2
from giraff_camera.device.image import DeviceError, cv2
from giraff_camera.device.opening import open_camera
from giraff_camera.device.simulated import SimulatedCamera
from giraff_camera.device.v4l2 import V4l2Camera
from giraff_node.process import libraries
from giraff_schemas.services import CAMERA, SERVICES
from giraff_schemas.trouble import Trouble

WIDTH, HEIGHT = 32, 24
PIXELS = np.arange(HEIGHT * WIDTH * 3, dtype=np.uint32).astype(np.uint8).reshape(HEIGHT, WIDTH, 3)


def trouble_with(path: Path | str) -> Trouble:
    """Why the camera at `path` cannot be opened."""
    with pytest.raises(DeviceError) as caught:
        open_camera(str(path), WIDTH, HEIGHT, 15.0)
    trouble = caught.value.trouble
    assert str(path) in trouble.what
    assert trouble.remedy
    return trouble


def test_what_is_no_camera_is_told_with_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "no such camera" in trouble_with(tmp_path / "video0").what
    (tmp_path / "file").touch()
    assert "no camera" in trouble_with(tmp_path / "file").what
    assert "no camera" in trouble_with("/dev/null").what

    def refuse(number: int) -> Any:
        def refused(*_: object) -> int:
            raise OSError(number, os.strerror(number))

        return refused

    for number, what in (
        (errno.ENODEV, "unplugged"),
        (errno.EBUSY, "another program"),
        (errno.EACCES, "not permitted"),
    ):
        monkeypatch.setattr(os, "open", refuse(number))
        assert what in trouble_with("/dev/null").what
    assert "usermod -aG video" in trouble_with("/dev/null").remedy


@pytest.mark.parametrize(
    ("whole", "own", "busy", "what"),
    [
        (0x84A00001, 0x04A00000, False, "no camera"),  # the device of a USB camera that gives its metadata
        (0x84A00001, 0x04200001, True, "another program uses"),
        (0x84A00001, 0x04200001, False, "does not start"),  # asked by OpenCV in earnest
        (0x00000001, 0x00000000, False, "does not start"),  # an old driver tells of itself as a whole
    ],
)
def test_the_driver_is_asked_before_opencv(
    whole: int, own: int, busy: bool, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def answered(_: object, request: int, data: bytearray) -> int:
        if request == opening._VIDIOC_QUERYCAP:
            data[84:92] = struct.pack("=II", whole, own)
        elif busy:
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY))
        return 0

    monkeypatch.setattr(fcntl, "ioctl", answered)
    assert what in trouble_with("/dev/null").what


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """Three pictures of 64 x 48 px, each of one grey."""
    path = tmp_path / "film.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (64, 48))
    for grey in (50, 100, 200):
        writer.write(np.full((48, 64, 3), grey, np.uint8))
    writer.release()
    return path


def test_pictures_are_scaled_to_the_size_of_the_robot_file(film: Path) -> None:
    """A film stands in for a camera: the same calls of the same library, and the time of its own clock."""
    camera = V4l2Camera(str(film), WIDTH, HEIGHT, 15.0, cv2.CAP_OPENCV_MJPEG)
    images = [camera.read() for _ in range(3)]
    assert [image.pixels.shape for image in images] == [(HEIGHT, WIDTH, 3)] * 3
    assert [round(float(image.pixels.mean()) / 10) for image in images] == [5, 10, 20]
    assert images[0].taken == camera._opened <= images[1].taken <= images[2].taken
    assert images[0].exposure is None
    with pytest.raises(DeviceError, match="the camera gives no picture"):
        camera.read()
    film.unlink()
    with pytest.raises(DeviceError, match="unplugged"):
        camera.read()
    camera.close()


def test_a_picture_of_another_shape_is_refused(film: Path) -> None:
    camera = V4l2Camera(str(film), 320, 200, 15.0, cv2.CAP_OPENCV_MJPEG)
    with pytest.raises(DeviceError, match=r"64 x 48 px.*set width and height"):
        camera.read()
    camera.close()


class Driver:
    """`cv2.VideoCapture` of a camera with MJPG, a clock and an exposure of its own."""

    def __init__(self, path: str, backend: int) -> None:
        assert (path, backend) == ("/dev/video7", cv2.CAP_V4L2)
        self.properties = {cv2.CAP_PROP_AUTO_EXPOSURE: 1.0, cv2.CAP_PROP_EXPOSURE: 200.0}
        self.jpegs: list[bytes] = []

    def isOpened(self) -> bool:  # noqa: N802  OpenCV's name
        return True

    def set(self, name: int, value: float) -> bool:
        self.properties[name] = value
        return True

    def get(self, name: int) -> float:
        return self.properties.get(name, -1.0)

    def grab(self) -> bool:
        return bool(self.jpegs)

    def retrieve(self) -> tuple[bool, NDArray[np.uint8]]:
        return True, np.frombuffer(self.jpegs.pop(0), np.uint8)[np.newaxis]

    def release(self) -> None: ...


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> V4l2Camera:
    monkeypatch.setattr(cv2, "VideoCapture", Driver)
    return V4l2Camera("/dev/video7", WIDTH, HEIGHT, 10.0)


def driver_of(camera: V4l2Camera) -> Driver:
    driver: Any = camera._capture
    assert isinstance(driver, Driver)
    return driver


JPEG = cv2.imencode(".jpg", PIXELS)[1].tobytes()


def test_a_camera_is_asked_for_the_size_and_rate_of_the_robot_file(camera: V4l2Camera) -> None:
    properties = driver_of(camera).properties
    asked = (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT, cv2.CAP_PROP_FPS, cv2.CAP_PROP_BUFFERSIZE)
    assert [properties[each] for each in asked] == [WIDTH, HEIGHT, 10.0, 2]
    assert properties[cv2.CAP_PROP_FOURCC] == cv2.VideoWriter.fourcc(*"MJPG")


def test_a_picture_has_the_time_and_exposure_of_the_driver(camera: V4l2Camera) -> None:
    driver = driver_of(camera)
    driver.jpegs = [JPEG] * 3
    camera._opened -= 5.0
    moment = camera._opened + 4.0
    driver.properties[cv2.CAP_PROP_POS_MSEC] = moment * 1e3
    image = camera.read()
    assert image.taken == pytest.approx(moment - 0.1)  # less a period
    assert image.exposure == pytest.approx(0.02)
    assert np.abs(image.pixels.astype(int) - cv2.imdecode(np.frombuffer(JPEG, np.uint8), 1)).max() == 0
    driver.properties |= {cv2.CAP_PROP_POS_MSEC: 1.7e12, cv2.CAP_PROP_AUTO_EXPOSURE: 3.0}
    image = camera.read()
    assert image.taken == pytest.approx(camera._opened + 5.0 - 0.1), "that of the buffer, not of another clock"
    assert image.exposure is None


def test_a_torn_jpeg_is_passed_over_and_many_are_told(camera: V4l2Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    driver = driver_of(camera)
    driver.jpegs = [JPEG[: len(JPEG) // 2], b"", JPEG[200:], JPEG + bytes(40)]
    assert camera.read().pixels.shape == PIXELS.shape
    driver.jpegs = [JPEG[:-10]] * v4l2._MOST_TORN
    monkeypatch.setattr(cv2, "imdecode", lambda *_: PIXELS)  # as OpenCV 4 does
    with pytest.raises(DeviceError, match=r"were torn; check its cable"):
        camera.read()


class Simulator:
    """The other side of the simulated camera's socket."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen()

    def accept(self) -> socket.socket:
        return self._listener.accept()[0]

    def close(self) -> None:
        self._listener.close()


@pytest.fixture
def simulator(tmp_path: Path) -> Iterator[Simulator]:
    made = Simulator(tmp_path / "camera.sock")
    yield made
    made.close()


def sent(pixels: NDArray[np.uint8] = PIXELS, **changed: Any) -> bytes:
    height, width = pixels.shape[:2]
    channels = 3 if pixels.ndim == 3 else 1
    header = {"width": width, "height": height, "channels": channels, "taken_ns": 10**9, "exposure_ns": 10**7}
    return json.dumps(header | changed).encode() + b"\n" + pixels.tobytes()


def opened(simulator: Simulator) -> tuple[SimulatedCamera, socket.socket]:
    device = open_camera(str(simulator.path), WIDTH, HEIGHT, 15.0)
    assert isinstance(device, SimulatedCamera)
    return device, simulator.accept()


def test_the_simulated_camera_is_asked_and_gives_its_pictures_as_they_are(simulator: Simulator) -> None:
    camera, peer = opened(simulator)
    assert json.loads(peer.makefile("rb").readline()) == {"width": WIDTH, "height": HEIGHT, "rate": 15.0}
    peer.sendall(sent() + sent(PIXELS[..., 0]))
    colour, grey = camera.read(), camera.read()
    assert [colour.taken, colour.exposure] == pytest.approx([1.0, 0.01])
    assert np.array_equal(colour.pixels, PIXELS)
    assert np.array_equal(grey.pixels, PIXELS[..., 0])
    camera.close()
    peer.close()


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"", "it has ended"),
        (sent()[:-1], "within a picture"),
        (sent(width=10**9, height=10**9), "none of its protocol: a picture of 1000000000"),
        (sent(taken_ns=10**300), "none of its protocol"),
        (sent(exposure_ns=-1), "another time"),
        (sent(channels=2), "none of its protocol"),
        (b"x" * 100_000, "none of its protocol"),
    ],
    ids=["ended", "torn", "large", "future", "negative", "channels", "noise"],
)
def test_what_is_no_picture_ends_the_connection(data: bytes, what: str, simulator: Simulator) -> None:
    camera, peer = opened(simulator)
    peer.sendall(data)
    peer.shutdown(socket.SHUT_WR)
    with pytest.raises(DeviceError, match=what):
        camera.read()
    camera.close()
    peer.close()


def test_a_library_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert {libraries.missing_library(service) for service in SERVICES} == {""}
    monkeypatch.setattr(libraries, "find_spec", lambda name: None if name == "cv2" else object())
    assert libraries.missing_library(CAMERA) == (
        f"the library opencv-python-headless is missing; {libraries.remedy('camera')}"
    )
