"""The live view of a run: a snapshot as a picture of 80 by 24 characters, or wider."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from giraff_cli.run.telemetry import RunSnapshot
from giraff_core.kinematics.pose import Pose
from giraff_schemas.services import LOCALIZATION, VISION
from giraff_schemas.text import printable
from giraff_telemetry import panels as blocks
from giraff_telemetry.describe import base_text, forward_text, localization_text, sensors_text
from giraff_telemetry.layout import HEADING, NONE, ServiceStatus, beside, block, clock, header, notice, right, services
from giraff_telemetry.panels import dim
from giraff_telemetry.visual_odometry import visual_text
from giraff_tools.terminal.addresses import CodeScreen


def line(snapshot: RunSnapshot, elapsed: float) -> str:
    """Return a run in one line, for where there is no terminal. `elapsed`: s since the run began."""
    truth, pose = snapshot.truth, snapshot.true_pose or Pose(0.0, 0.0, 0.0)
    parts = [
        f"{elapsed:6.1f} s",
        f"x {pose.x:z6.2f} y {pose.y:z6.2f} m, {math.degrees(pose.yaw):z6.1f}°",
        f"path {truth.path:6.2f} m",
        f"{truth.speed:z5.2f} m/s",
        sensors_text(snapshot),
        f"forward {forward_text(snapshot.guard)}",
        f"base {base_text(snapshot)}",
        f"lost {sum(rate.lost for rate in snapshot.rates.values())}",
    ]
    if snapshot.localization is not None:
        parts.append(f"map {localization_text(snapshot)}")
    if (off := snapshot.off_map) is not None:
        parts.append(f"off {off.distance:.2f} m, {math.degrees(off.angle):.1f}°")
    if snapshot.seen is not None:
        parts.append(f"camera {visual_text(snapshot.seen)}")
    return " | ".join(parts)


_TOPIC_COLUMNS: Final = 3
_IN_THE_LAST_ROW: Final = (LOCALIZATION.name, VISION.name)


@dataclass(frozen=True, kw_only=True)
class Frame:
    """What is around the snapshot."""

    robot: str
    boards: str
    seed: int
    elapsed: float
    """s since the run began."""
    seconds: float | None
    """How long it is to go on; None: until Ctrl-C."""
    hints: Sequence[str]
    """What a person can do, a line each."""
    note: str
    """What the demonstration does instead of driving; empty: it drives."""
    code_key: str = ""
    """The key that shows the code of the page's address. Empty: none does."""
    services: dict[str, ServiceStatus]
    look: str = ""
    """How to see by its camera; empty: it has none."""
    ended: str = ""
    """The service that ended last, how, and where its log is. Empty: none did."""
    notices: tuple[str, ...]
    """What went wrong so far, one line each."""


@dataclass(frozen=True)
class RunView:
    """A run at one moment, for any screen."""

    snapshot: RunSnapshot
    frame: Frame
    code: CodeScreen | None = None
    """It takes the place of the picture. None: the picture is shown."""

    @property
    def elapsed(self) -> float:
        """s since the run began."""
        return self.frame.elapsed

    def render(self) -> RenderableType:
        return self.code or view(self.snapshot, self.frame)

    def line(self) -> str:
        told = line(self.snapshot, self.elapsed)
        return f"{told} | {self.frame.note}" if self.frame.note else told


def _hints(frame: Frame) -> list[Text]:
    """Return rows, as many whatever they say. Only a command or an address folds, since it is to be typed."""
    first, *others = (Text(printable(hint), style="green", overflow="fold") for hint in frame.hints)
    note = Text(printable(frame.note), style="green", no_wrap=True, overflow="ellipsis")
    return others if frame.ended else [note if frame.note else first, *others]


def view(snapshot: RunSnapshot, frame: Frame) -> RenderableType:
    """The picture."""
    truth = snapshot.truth
    return Group(
        _header(frame),
        *([notice(frame.ended)] if frame.ended else []),
        *_hints(frame),
        beside(_poses(snapshot), blocks.motion(truth.path, truth.speed, truth.turn), _hand(snapshot)),
        beside(blocks.ranges(snapshot), blocks.base(snapshot, ("command", _age(snapshot)))),
        blocks.guard(snapshot),
        blocks.command(snapshot),
        blocks.topics(snapshot, _TOPIC_COLUMNS),
        services([row for row in frame.services.items() if row[0] not in _IN_THE_LAST_ROW]),
        *_last_row(snapshot, frame),
    )


def _last_row(snapshot: RunSnapshot, frame: Frame) -> list[RenderableType]:
    """What went wrong, else the place on the map, else how it balances, else how to see by it: there is one row."""
    if frame.notices:
        return [Text(printable(text), style="red", overflow="fold") for text in frame.notices]  # the terminal cuts it
    localization = frame.services.get(LOCALIZATION.name)
    if localization is None:
        if snapshot.attitude is not None:
            return [blocks.balance(snapshot)]
        return [_camera(snapshot, frame)] if frame.look else []
    off = snapshot.off_map
    told = "" if off is None else f"off {off.distance:.2f} m, {math.degrees(off.angle):.1f}°"
    return [blocks.localization(snapshot, told if localization == "alive" else localization)]


def _camera(snapshot: RunSnapshot, frame: Frame) -> Text:
    """Whether the motion is seen, and how a person sees by it."""
    text = Text(no_wrap=True, overflow="ellipsis")
    if (vision := frame.services.get(VISION.name)) is not None:
        told = visual_text(snapshot.seen) if vision == "alive" and snapshot.seen is not None else vision
        text.append("VISION  ", HEADING).append(f"{printable(told)}  ")
    return text.append(printable(frame.look), "green")


def _header(frame: Frame) -> RenderableType:
    time = clock(frame.elapsed)
    if frame.seconds is not None:
        time += f" of {clock(frame.seconds)}"
    return header(
        (f"giraff run · {frame.robot}", "bold"),
        *([(f" · {frame.code_key} shows the code", "green")] if frame.code_key else []),
        (f" · {frame.boards} boards · seed {frame.seed} · ", "dim"),
        (time, "bold"),
    )


def _poses(snapshot: RunSnapshot) -> Table:
    table = block("POSE", 8, right("x m", 8), right("y m", 8), right("yaw °", 7))
    odometry, apart = snapshot.odometry, snapshot.apart
    believed = None if odometry is None else Pose(odometry.sample.x, odometry.sample.y, odometry.sample.yaw)
    table.add_row("odometry", *_pose(believed), style=dim(odometry))
    table.add_row("truth", *_pose(snapshot.true_pose))
    if apart is None:
        table.add_row("apart", NONE, "", NONE)
    else:
        table.add_row("apart", f"{apart.distance:.3f}", "", f"{math.degrees(apart.angle):.1f}")
    return table


def _hand(snapshot: RunSnapshot) -> Table:
    tilt = snapshot.tilt
    table = block("TILT", 7, right("m/s²", 6))
    if tilt is not None and tilt.sample.status != "running":
        table.columns[1].header = Text(tilt.sample.status.replace("_", " "), style="red")
    for axis, meaning in (("x", "forward"), ("y", "left"), ("z", "up")):
        value = NONE if tilt is None else f"{getattr(tilt.sample, axis):z.2f}"
        table.add_row(meaning, value, style=dim(tilt))
    return table


def _age(snapshot: RunSnapshot) -> RenderableType:
    age = snapshot.age_ms
    return NONE if age is None else f"{age.p50:.0f} ms, p99 {age.p99:.0f}, most {age.max:.0f}"


def _pose(pose: Pose | None) -> tuple[RenderableType, RenderableType, RenderableType]:
    if pose is None:
        return NONE, NONE, NONE
    return f"{pose.x:z.3f}", f"{pose.y:z.3f}", f"{math.degrees(pose.yaw):z.1f}"
