"""`giraff camera list` and `view`: which cameras a robot has, who looks, and what one sees, in a window or a file."""

import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.picture.receiver import PictureReceiver
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.network.tokens import list_robots
from giraff_schemas.camera import Asker, CameraState, Picture
from giraff_schemas.text import printable
from giraff_schemas.topics import CAMERA_STATE
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.pictures import pictures_for
from giraff_tools.terminal.page import print_json, print_table, shown
from giraff_tools.terminal.signals import StopSignal

_FIRST_WITHIN: Final = 3.0  # s, to hear a camera
_MEET: Final = 0.5  # s after the first camera in which all others are heard
_LOOK_EVERY: Final = 0.05  # s
_TURN: Final = 0.03  # s
_PICTURE_WITHIN: Final = 10.0  # s; a camera that wakes up takes a moment
HEADINGS: Final = ("camera", "", ">size", ">Hz", "seen by", "trouble")

_DONE: Final = 0
_NO_PICTURE: Final = 1


class CameraReport(msgspec.Struct, frozen=True, kw_only=True):
    """State of a camera."""

    name: str
    on: bool
    """It sends pictures, because somebody looks."""
    askers: tuple[Asker, ...]
    """Viewers of it."""
    width: int
    """px of a full picture."""
    height: int
    rate: float
    """Hz. Pictures that it took in the last second."""
    trouble: str
    """Cause, where somebody looks and there are no pictures; empty: nothing is wrong."""


class Cameras(msgspec.Struct, frozen=True, kw_only=True):
    """The answer of `giraff camera list`."""

    robot: str
    cameras: tuple[CameraReport, ...]


def list_cameras(robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Listen for `seconds` and print it; the exit code."""

    def act(connection: RobotConnection) -> int:
        heard = hear_cameras(connection, PictureReceiver(None), stopping, seconds)
        cameras = Cameras(robot=connection.robot, cameras=tuple(map(report_of, heard.values())))
        if as_json:
            print_json(cameras)
        else:
            print_table(HEADINGS, rows_of(cameras))
        return _DONE

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def report_of(state: CameraState) -> CameraReport:
    """Return what a camera has said of itself."""
    return CameraReport(
        name=state.camera,
        on=bool(state.askers),
        askers=state.askers,
        width=state.width,
        height=state.height,
        rate=state.rate,
        trouble=str(state.reason),
    )


def rows_of(cameras: Cameras) -> list[tuple[str, ...]]:
    """Return a row a camera, for people."""
    return [
        (
            each.name,
            "on" if each.on else "off",
            f"{each.width} x {each.height}",
            shown(each.rate if each.on else None),
            ", ".join(f"{asker.by} ({asker.size}{', late' if asker.is_late else ''})" for asker in each.askers),
            each.trouble,
        )
        for each in cameras.cameras
    ]


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
        with closing(pictures_for(connection, "camera view")) as pictures:
            camera = choose_camera(connection.robot, hear_cameras(connection, pictures, stopping, _MEET), name)
            if save is None:
                from giraff_cli.camera.window import show  # noqa: PLC0415  needs the extra `viewer`

                return show(connection, pictures, camera, seconds, stopping)
            patience = _PICTURE_WITHIN if seconds is None else seconds
            picture: Picture | None = None
            is_last, until = False, time.monotonic() + patience
            while picture is None and not is_last:
                is_last = stopping.wait(_TURN) or time.monotonic() >= until
                set_tcp_options()
                connection.dispatch(pictures)
                picture = pictures.ask_best(camera, time.monotonic(), is_last=is_last)
            if picture is not None:
                return _write(picture, save, as_json=as_json)
            print_error(str(pictures.trouble(camera)) or f"no picture came in {patience:g} s")
            return _NO_PICTURE

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def hear_cameras(
    connection: RobotConnection, cameras: PictureReceiver, stopping: StopSignal, seconds: float
) -> dict[str, CameraState]:
    """Return by name the newest state of each camera that is heard within `seconds` of the first.

    Raises NoRobotError where there is no robot, or no camera of it is heard.
    """
    connection.subscribe(CAMERA_STATE)
    until, is_first = time.monotonic() + _FIRST_WITHIN, True
    while time.monotonic() < until and not stopping.wait(_LOOK_EVERY):
        connection.dispatch(cameras)
        if cameras.heard and is_first:
            until, is_first = time.monotonic() + seconds, False
    if cameras.heard:
        return dict(sorted(cameras.heard.items()))
    if connection.robot not in (there := list_robots(connection.session)):
        raise NoRobotError(not_found_text(connection.robot, there))
    remedy = "check that giraff_camera runs, and the tables [camera] and [robot.sensors] of the robot file"
    raise NoRobotError(f"no camera of {connection.robot} is heard; {remedy}")


def choose_camera(robot: str, states: Mapping[str, CameraState], name: str | None) -> str:
    """Return the camera that is meant. Raises NoRobotError."""
    there = ", ".join(states)
    if name is None and len(states) > 1:
        raise NoRobotError(f"{robot} has several cameras; name one of {there}")
    if name is not None and name not in states:
        raise NoRobotError(f"{robot} has no camera {name!r}; there are: {there}")
    return name or next(iter(states))


def _write(picture: Picture, path: Path, *, as_json: bool) -> int:
    try:
        path.write_bytes(picture.jpeg)
    except OSError as error:
        print_error(f"{path} cannot be written: {error.strerror}")
        return _NO_PICTURE
    if as_json:
        print_json({"file": str(path), "width": picture.width, "height": picture.height, "bytes": len(picture.jpeg)})
    else:
        print(printable(f"{path}: {picture.width} x {picture.height}, {len(picture.jpeg)} bytes"))
    return _DONE
