"""`giraff camera list`: which cameras a robot has, and who sees what they see."""

from collections.abc import Sequence
from typing import Final

import msgspec

from giraff_cli.camera.hearing import hear_cameras
from giraff_schemas.camera import Asker, CameraState
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.page import print_json, print_table, shown
from giraff_tools.terminal.signals import StopSignal

_DONE: Final = 0


class CameraReport(msgspec.Struct, frozen=True, kw_only=True):
    """How a camera is."""

    name: str
    on: bool
    """It sends pictures, because somebody looks."""
    askers: tuple[Asker, ...]
    """Who looks."""
    width: int
    """px of a full picture."""
    height: int
    rate: float
    """Hz. Pictures that it took in the last second."""
    trouble: str
    """Why there are no pictures though somebody looks; empty: nothing is wrong."""


class Cameras(msgspec.Struct, frozen=True, kw_only=True):
    """The answer of `giraff camera list`."""

    robot: str
    cameras: tuple[CameraReport, ...]


def list_cameras(robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Listen for `seconds` and print it; the exit code."""

    def act(connection: RobotConnection) -> int:
        states = hear_cameras(connection, stopping, seconds)
        cameras = Cameras(robot=connection.robot, cameras=tuple(map(report_of, states.values())))
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


HEADINGS: Final = ("camera", "", ">size", ">Hz", "seen by", "trouble")


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
