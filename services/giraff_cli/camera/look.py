"""`giraff camera view`: what a camera of the robot sees, in a window or a file."""

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from giraff_cli.camera.hearing import hear_cameras
from giraff_core.picture.asker import PictureChoice
from giraff_node.network.consent import NoRobotError
from giraff_node.network.tcp_options import set_tcp_options
from giraff_schemas.camera import CameraState, Picture
from giraff_schemas.text import printable
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.picture_subscriber import PictureSubscriber
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.signals import StopSignal

_MEET: Final = 0.5  # s after the first camera in which all others are heard
_TURN: Final = 0.03  # s
_PICTURE_WITHIN: Final = 10.0  # s; a camera that wakes up takes a moment

_DONE: Final = 0
_NO_PICTURE: Final = 1


def view_camera(
    name: str | None,
    robot: str | None,
    connect: Sequence[str],
    save: Path | None,
    seconds: float | None,
    *,
    as_json: bool,
) -> int:
    """Show it until the end, or save one picture; return the exit code."""
    if save is not None and not save.absolute().parent.is_dir():
        return print_error(f"--save {save}: there is no such folder; make it first")

    def act(connection: RobotConnection) -> int:
        states = hear_cameras(connection, stopping, _MEET)
        camera = choose_camera(connection.robot, states, name)
        with PictureSubscriber.of(connection, "camera view", camera) as pictures:
            if save is not None:
                patience = _PICTURE_WITHIN if seconds is None else seconds
                return _save(connection, pictures, save, patience, stopping, as_json=as_json)
            from giraff_cli.camera.window import show  # noqa: PLC0415  needs the extra `viewer`

            return show(connection, pictures, camera, seconds, stopping)

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def choose_camera(robot: str, states: Mapping[str, CameraState], name: str | None) -> str:
    """Return the camera that is meant. Raises NoRobotError."""
    there = ", ".join(states)
    if name is None and len(states) > 1:
        raise NoRobotError(f"{robot} has several cameras; name one of {there}")
    if name is not None and name not in states:
        raise NoRobotError(f"{robot} has no camera {name!r}; there are: {there}")
    return name or next(iter(states))


def _save(
    connection: RobotConnection,
    pictures: PictureSubscriber,
    path: Path,
    seconds: float,
    stopping: StopSignal,
    *,
    as_json: bool,
) -> int:
    """Write one picture; the exit code. `seconds`: how long it is waited for."""
    choice, until = PictureChoice(), time.monotonic() + seconds
    taken: Picture | None = None
    while taken is None and (now := time.monotonic()) < until and not stopping.wait(_TURN):
        set_tcp_options()
        connection.dispatch(pictures)
        for full_width, picture in pictures.pop_pictures():
            taken = choice.choose(picture, full_width, now)
    if (taken := taken or choice.give_up()) is None:
        print_error("; ".join(pictures.troubles()) or f"no picture came in {seconds:g} s")
        return _NO_PICTURE
    try:
        path.write_bytes(taken.jpeg)
    except OSError as error:
        print_error(f"{path} cannot be written: {error.strerror}")
        return _NO_PICTURE
    if as_json:
        print_json({"file": str(path), "width": taken.width, "height": taken.height, "bytes": len(taken.jpeg)})
    else:
        print(printable(f"{path}: {taken.width} x {taken.height}, {len(taken.jpeg)} bytes"))
    return _DONE
