"""The thread that reads a camera: the newest picture, a camera that fails, one that hangs."""

import socket
import time
from collections.abc import Iterator
from pathlib import Path
from queue import Queue

import msgspec
import numpy as np
import pytest

from giraff_camera.device import capture as subject
from giraff_camera.device.capture import Capture
from giraff_camera.device.image import Device, DeviceError, Image
from giraff_camera.device.opening import open_camera
from giraff_camera.device.raw_frames import Header
from giraff_node.process.selector import wait_for
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.support.waiting import wait

UNPLUGGED = Trouble("unplugged", "plug it in")


class Scripted:
    """A camera that gives what a test puts into `pictures`: a picture by its time, or what is wrong."""

    def __init__(self) -> None:
        self.pictures: Queue[float | Trouble] = Queue()
        self.opened = self.closed = self.reads = 0
        self.time = 100.0

    def open(self) -> Device:
        self.opened += 1
        return self

    def read(self) -> Image:
        self.reads += 1
        picture = self.pictures.get()
        if isinstance(picture, Trouble):
            raise DeviceError(picture)
        return Image(np.zeros((2, 2), np.uint8), picture, None)

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def camera() -> Scripted:
    return Scripted()


@pytest.fixture
def capture(camera: Scripted, monkeypatch: pytest.MonkeyPatch) -> Iterator[Capture]:
    monkeypatch.setattr(subject, "REOPEN_PERIOD", 0.0)
    made = Capture(camera.open, lambda: camera.time)
    yield made
    made.stop()
    camera.pictures.put(UNPLUGGED)
    made.close()
    assert not made._thread.is_alive()


def readable(capture: Capture) -> bool:
    return wait_for([capture], 0.0) == {capture}


def taken(capture: Capture) -> Image:
    wait(lambda: readable(capture))
    image = capture.pop_picture()
    assert image is not None
    return image


def test_the_camera_is_open_only_while_somebody_wants_pictures(camera: Scripted, capture: Capture) -> None:
    assert (camera.opened, capture.rate) == (0, 0.0)
    capture.start()
    capture.start()
    camera.pictures.put(1.0)
    assert taken(capture).taken == 1.0
    assert (capture.pop_picture(), readable(capture), capture.rate) == (None, False, 1.0)
    camera.time += 1.0
    assert capture.rate == 0.0
    capture.stop()
    camera.pictures.put(2.0)  # under way when it was stopped
    wait(lambda: camera.closed == 1)
    assert (camera.opened, capture.pop_picture(), readable(capture), capture.fault) == (1, None, False, NO_TROUBLE)


def test_the_newest_picture_wins_and_none_outlives_a_stop(camera: Scripted, capture: Capture) -> None:
    capture.start()
    for number in range(5):
        camera.pictures.put(float(number))
    wait(lambda: capture.rate == 5.0)
    assert (taken(capture).taken, capture.pop_picture()) == (4.0, None)
    camera.pictures.put(5.0)
    wait(lambda: capture.rate == 6.0)
    capture.stop()
    assert (readable(capture), capture.pop_picture()) == (False, None)


def test_a_camera_that_is_unplugged_is_opened_again(camera: Scripted, capture: Capture) -> None:
    capture.start()
    camera.pictures.put(UNPLUGGED)
    wait(lambda: capture.fault == UNPLUGGED)
    camera.pictures.put(1.0)
    assert taken(capture).taken == 1.0
    assert (capture.fault, camera.closed, camera.opened) == (NO_TROUBLE, 1, 2)


def test_a_camera_that_hangs_is_a_fault_and_after_half_a_minute_the_end(camera: Scripted, capture: Capture) -> None:
    capture.start()
    wait(lambda: camera.reads == 1)
    assert capture.fault == NO_TROUBLE
    camera.time += subject.HANGS
    assert "does not answer" in capture.fault.what
    stuck = [capture.is_stuck]
    capture.stop()
    camera.time += subject.STUCK
    stuck.append(capture.is_stuck)
    assert stuck == [False, True], "it holds the camera, though nobody looks"
    capture.start()
    camera.pictures.put(1.0)
    assert taken(capture).taken == 1.0
    assert (capture.is_stuck, capture.fault, camera.opened) == (False, NO_TROUBLE, 1)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_an_error_that_nobody_thought_of_is_told() -> None:
    def broken() -> Device:
        raise ZeroDivisionError

    capture = Capture(broken)
    capture.start()
    capture._thread.join()
    assert (capture.is_stuck, "ended by an error" in capture.fault.what) == (True, True)
    capture.close()


def listening(path: Path) -> socket.socket:
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(path))
    listener.listen()
    return listener


def test_a_simulated_camera_that_says_nothing_hangs_and_one_that_is_started_again_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(subject, "REOPEN_PERIOD", 0.01)
    path = tmp_path / "camera.sock"
    listener = listening(path)
    capture = Capture(lambda: open_camera(str(path), 4, 3, 15.0))
    capture.start()
    peer, _ = listener.accept()
    wait(lambda: "does not answer" in capture.fault.what)
    listener.close()
    path.unlink()
    peer.close()
    wait(lambda: "no such camera" in capture.fault.what)
    listener = listening(path)
    peer, _ = listener.accept()
    header = Header(width=4, height=3, channels=1, taken_ns=time.monotonic_ns(), exposure_ns=1)
    peer.sendall(msgspec.json.encode(header) + b"\n" + bytes(12))
    pictures: list[Image] = []

    def came() -> bool:
        pictures.extend(filter(None, [capture.pop_picture()]))
        return bool(pictures)

    wait(came)
    assert not capture.fault
    capture.stop()
    peer.close()
    capture.close()
    listener.close()
