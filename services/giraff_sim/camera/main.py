"""The simulated camera as a process: it gives its pictures at a Unix socket, to one reader at a time.

Nothing is drawn while nobody reads.
"""

import argparse
import contextlib
import logging
import math
import select
import signal
import socket
import time
from pathlib import Path
from typing import Final

import msgspec

from giraff_camera.config import CameraConfig, camera_of
from giraff_camera.device.raw_frames import Header, Wanted
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_node.config.robot_file import ConfigError, load
from giraff_node.process.c_library import keep_freed_memory
from giraff_node.process.logs import service_logger
from giraff_node.process.unix_socket import listen_at
from giraff_schemas.text import plain
from giraff_sim.camera.lens import resized
from giraff_sim.camera.renderer import Picture, Renderer
from giraff_sim.camera.scene import Scene, Shadow
from giraff_sim.camera.solids import Solids
from giraff_sim.camera.textures import FLOORS
from giraff_sim.control.client import SimulatorClient, SimulatorError
from giraff_sim.control.messages import State
from giraff_sim.world.room import Pose

_log = logging.getLogger(__name__)

_LOOK_EVERY: Final = 0.5  # s, at the end that was asked for and at the simulator
_PATIENCE: Final = 2.0  # s for a reader that says nothing, or takes nothing
_LONGEST_LINE: Final = 1000
_SIZES: Final = range(16, 1921)
_FASTEST: Final = 60.0  # Hz


class _Refused(Exception):  # noqa: N818  # the reader's error, not this process's
    """A reader has asked for what there is not."""


class SimulatedCamera:
    """Its picture of the moment, from what the simulator says."""

    def __init__(self, client: SimulatorClient, camera: Camera, scene: Scene, seed: int) -> None:
        """`camera`: of the robot file."""
        self._client = client
        self._camera = client.truth().camera.of(camera)
        self._scene, self._seed = scene, seed
        self._renderer = Renderer(self._camera, scene, seed=seed)
        self._size = camera.width, camera.height
        self._room_version = -1

    def resize(self, width: int, height: int) -> None:
        """Give pictures of this size from now on."""
        if self._size != (width, height):
            self._renderer = Renderer(resized(self._camera, width, height), self._scene, seed=self._seed)
            self._size, self._room_version = (width, height), -1

    def capture(self) -> tuple[Header, Picture]:
        """Return a picture whose exposure ends now. Raises SimulatorError."""
        exposure = self._scene.exposure
        asked_ns = time.monotonic_ns()
        state = self._client.state()
        now_ns = (asked_ns + time.monotonic_ns()) // 2
        if state.room_version != self._room_version:
            room = self._client.room()
            self._renderer.solids, self._room_version = Solids(room.walls, room.posts), room.version
        picture = self._renderer.frame(
            _moved(state, -exposure / 2),
            state.now_us * 1e-6 - exposure / 2,
            speed=state.speed,
            turn=state.turn,
            lean=state.lean,
            pivot=state.pivot,
        )
        height, width, _ = picture.shape
        exposure_ns = round(exposure * 1e9)
        return Header(
            width=width, height=height, channels=3, taken_ns=now_ns - exposure_ns, exposure_ns=exposure_ns
        ), picture


class CameraServer:
    """The socket and its reader."""

    def __init__(self, path: Path, camera: SimulatedCamera, client: SimulatorClient) -> None:
        """Raises OSError."""
        self._path, self._camera, self._client = path, camera, client
        self._listener = listen_at(path)
        self._stopping = False

    def stop(self) -> None:
        """End after this picture."""
        self._stopping = True

    def run(self) -> None:
        """Serve until stopped. Raises SimulatorError when the simulator has ended."""
        while not self._stopping:
            if not select.select([self._listener], [], [], _LOOK_EVERY)[0]:
                self._client.now()
                continue
            with self._listener.accept()[0] as reader:
                reader.settimeout(_PATIENCE)
                try:
                    self._serve(reader, _wanted(reader))
                except (_Refused, OSError) as error:
                    _log.info("a reader has gone: %s", error)

    def close(self) -> None:
        """Take the path away."""
        self._listener.close()
        self._path.unlink(missing_ok=True)

    def _serve(self, reader: socket.socket, wanted: Wanted) -> None:
        self._camera.resize(wanted.width, wanted.height)
        due = time.monotonic()
        while not self._stopping:
            header, picture = self._camera.capture()
            reader.sendall(msgspec.json.encode(header) + b"\n")
            reader.sendall(picture.tobytes())
            due = max(due + 1.0 / wanted.rate, time.monotonic())
            while (left := due - time.monotonic()) > 0.0 and not self._stopping:
                readable, _, _ = select.select([reader, self._listener], [], [], min(left, _LOOK_EVERY))
                if reader in readable and not reader.recv(_LONGEST_LINE):
                    return
                if self._listener in readable:
                    self._turn_away()

    def _turn_away(self) -> None:
        """A camera has one reader. Another one sees the end at once."""
        with contextlib.suppress(OSError):
            self._listener.accept()[0].close()


def _wanted(reader: socket.socket) -> Wanted:
    received = b""
    while b"\n" not in received:
        data = reader.recv(_LONGEST_LINE)
        received += data
        if not data or len(received) > _LONGEST_LINE:
            raise _Refused("it has not said what it wants")
    try:
        wanted = msgspec.json.decode(received.partition(b"\n")[0], type=Wanted)
    except msgspec.DecodeError as error:
        raise _Refused(f"not a request: {plain(error)}") from error
    if wanted.width not in _SIZES or wanted.height not in _SIZES or not 0.0 < wanted.rate <= _FASTEST:
        raise _Refused(f"there are no pictures of {wanted.width} by {wanted.height} at {wanted.rate:g} Hz")
    return wanted


def _moved(state: State, seconds: float) -> Pose:
    """Return where the robot is a moment later, or before."""
    yaw, way = state.yaw + state.turn * seconds, state.speed * seconds
    middle = state.yaw + state.turn * seconds / 2
    return Pose(state.x + way * math.cos(middle), state.y + way * math.sin(middle), yaw)


def main(arguments: list[str] | None = None) -> int:
    """Run the simulated camera until SIGTERM or SIGINT, or the simulator's end; the exit status."""
    parser = argparse.ArgumentParser(prog="giraff_sim.camera", description=__doc__)
    add = parser.add_argument
    add("--control", type=Path, required=True, metavar="PATH", help="the simulator's control socket")
    add("--at", type=Path, required=True, metavar="PATH", help="socket for who reads the pictures")
    add("--seed", type=int, default=1, metavar="N", help="of everything random (default 1)")
    add("--floor", choices=FLOORS, default="planks", help="(default planks)")
    given = parser.parse_args(arguments)
    keep_freed_memory()
    service_logger("giraff_sim")
    try:
        _, camera = camera_of(load("camera", CameraConfig), load("robot", RobotConfig))
        with SimulatorClient(given.control) as client:
            scene = Scene(floor=given.floor, shadow=Shadow())
            server = CameraServer(given.at, SimulatedCamera(client, camera, scene, given.seed), client)
            for number in (signal.SIGTERM, signal.SIGINT):
                signal.signal(number, lambda _number, _frame: server.stop())
            try:
                server.run()
            finally:
                server.close()
    except (ConfigError, SimulatorError, ValueError, OSError) as error:
        _log.error("%s", error)
        return 1
    return 0
