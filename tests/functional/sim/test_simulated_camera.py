"""The simulated camera's socket: who reads gets pictures of the room as it is now, one reader at a time."""

import json
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, cast

import msgspec
import numpy as np
import pytest

from giraff_camera.device.raw_frames import Header, Wanted
from giraff_core.senses import Camera
from giraff_sim.camera.main import CameraServer, SimulatedCamera
from giraff_sim.camera.scene import Scene
from giraff_sim.control.client import SimulatorClient
from giraff_sim.control.control import Control
from giraff_sim.control.messages import Reply, State, Surfaces
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.truth import Truth
from giraff_sim.world.hand import StillHand
from tests.sim.robots import room_with_wall, world_in

CAMERA = Camera(z=1.0, pitch=0.35)


class Simulator:
    """The control protocol without its socket."""

    def __init__(self) -> None:
        self.control = Control(Simulation({}, world_in(room_with_wall(3.0))), {}, WallPacer(), lambda *_: StillHand())
        self.asked: list[str] = []

    def ask(self, op: str, **more: object) -> Reply:
        self.asked.append(op)
        reply = self.control.answer(json.dumps({"op": op, **more}).encode())
        assert reply.ok, reply.error
        return reply

    def state(self) -> State:
        return cast("State", self.ask("state").state)

    def room(self) -> Surfaces:
        return cast("Surfaces", self.ask("room").room)

    def truth(self) -> Truth:
        return cast("Truth", self.ask("truth").truth)

    def now(self) -> int:
        return self.ask("now").now_us


@pytest.fixture
def simulator() -> Simulator:
    return Simulator()


@pytest.fixture
def path(tmp_path: Path, simulator: Simulator) -> Iterator[Path]:
    """The socket, served until the test is over."""
    client = cast("SimulatorClient", simulator)
    server = CameraServer(tmp_path / "camera", SimulatedCamera(client, CAMERA, Scene(noise=0.0), 1), client)
    thread = threading.Thread(target=server.run)
    thread.start()
    yield tmp_path / "camera"
    server.stop()
    thread.join()
    server.close()
    assert not (tmp_path / "camera").exists()


def call(path: Path, width: int = 160, height: int = 120) -> tuple[socket.socket, BinaryIO]:
    reader = socket.socket(socket.AF_UNIX)
    reader.settimeout(60.0)
    reader.connect(str(path))
    reader.sendall(msgspec.json.encode(Wanted(width=width, height=height, rate=30.0)) + b"\n")
    return reader, cast("BinaryIO", reader.makefile("rb"))


def take(pictures: BinaryIO) -> tuple[Header, np.ndarray[tuple[int, ...], np.dtype[np.uint8]]]:
    header = msgspec.json.decode(pictures.readline(), type=Header)
    shape = header.height, header.width, header.channels
    return header, np.frombuffer(pictures.read(shape[0] * shape[1] * shape[2]), np.uint8).reshape(shape)


def test_a_reader_sees_the_room_of_now(path: Path, simulator: Simulator) -> None:
    before = time.monotonic_ns()
    reader, pictures = call(path)
    header, first = take(pictures)
    assert (header.width, header.height) == (160, 120)
    assert before - header.exposure_ns <= header.taken_ns <= time.monotonic_ns() - header.exposure_ns
    simulator.ask("add_wall", name="box", points=[[2.0, -0.5], [2.0, 0.5]])
    changed = next(picture for _, picture in iter(lambda: take(pictures), None) if (picture != first).any())
    simulator.ask("place", x=0.5, y=0.0)
    assert any((picture != changed).any() for _, picture in iter(lambda: take(pictures), None))
    reader.close()


def test_one_reader_at_a_time_and_no_picture_for_nobody(path: Path, simulator: Simulator) -> None:
    reader, pictures = call(path)
    take(pictures)
    other = socket.socket(socket.AF_UNIX)
    other.settimeout(60.0)
    other.connect(str(path))
    turned_away = threading.Event()

    def end() -> None:
        assert other.recv(1) == b""
        turned_away.set()

    threading.Thread(target=end).start()
    while not turned_away.is_set():
        take(pictures)
    for each in (other, pictures, reader):
        each.close()
    while simulator.asked[-1] != "now":  # the server has noticed, and waits again
        time.sleep(0.01)
    reader, pictures = call(path, 64, 48)  # another size
    assert take(pictures)[1].shape == (48, 64, 3)
    pictures.close()
    reader.close()
