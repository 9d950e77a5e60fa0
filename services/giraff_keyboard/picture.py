"""What a person who drives sees at one moment, on 80 by 24 characters or wider. Nothing moves when a text grows."""

import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Final

import msgspec
from rich.console import Console, ConsoleOptions, Group, RenderableType
from rich.text import Text

from giraff_core.latest import FRESH, Latest
from giraff_core.operator import what_stops
from giraff_core.senses import SENSED
from giraff_keyboard.policy import KeyboardPolicy
from giraff_keyboard.reset_request import before_release, release_question
from giraff_schemas.actions import KEYS
from giraff_schemas.text import printable
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, ODOM, SampleT, Topic
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import RANGE_SENSORS
from giraff_telemetry import panels as blocks
from giraff_telemetry.collector import Snapshot, Telemetry
from giraff_telemetry.describe import DIRECTIONS, moving, verdicts
from giraff_telemetry.layout import HEADING, beside, clock, header

COLUMNS: Final = 80
ROWS: Final = 24
_LABEL: Final = 7  # characters
_DIRECTION: Final = 11  # characters
_ROWS_OF_A_TEXT: Final = 3
_ROWS_OF_A_DIRECTION: Final = 2
_GOOD, _WAITS, _BAD, _ALARM = "green", "yellow", "red", "bold red"


@dataclass(frozen=True)
class Paragraph:
    """Text that takes `rows` rows, however long it is; what is too long for them ends with `…`."""

    head: Text
    """What stands before it in the first row."""
    text: str
    style: str
    rows: int
    indent: int
    """Of the other rows, characters."""
    low_rows: int | None = None
    """Rows in a terminal that is lower than ROWS. None: as many."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        width, head = options.max_width, self.head.cell_len
        count = self.rows if self.low_rows is None or console.height >= ROWS else self.low_rows
        lines = textwrap.wrap(
            printable(self.text),
            width,
            initial_indent=" " * head,
            subsequent_indent=" " * self.indent,
            max_lines=count,
            placeholder=" …",
        )
        first, *more = lines or [""]
        rows = [Text.assemble(self.head, (first[head:], self.style))]
        rows += [Text.assemble(" " * self.indent, (line[self.indent :], self.style)) for line in more]
        for row in islice([*rows, *[Text()] * count], count):
            row.no_wrap, row.overflow = True, "ellipsis"
            yield row


@dataclass(frozen=True, kw_only=True)
class DrivePicture:
    """The robot, and what becomes of the keys."""

    robot: str
    elapsed: float
    """s since the screen was opened."""
    snapshot: Snapshot
    is_lost: bool
    """The robot's clock is not heard."""
    is_mine: bool
    driver: str
    """Whom the guard obeys; empty: nobody."""
    why: Trouble
    """What stops the robot. NO_TROUBLE: nothing does."""
    stop: Trouble
    """What became of an emergency stop, or of its release, that was asked for here."""
    step: int
    steps: int
    speed: tuple[float, float]
    """m/s and rad/s that a key asks for."""

    def render(self) -> RenderableType:
        snapshot = self.snapshot
        gap = blocks.gap(snapshot)
        most = RANGE_SENSORS if gap else RANGE_SENSORS + 2  # in the rows of two gaps
        few = replace(snapshot, sensed=dict(islice(snapshot.sensed.items(), most)))
        return Group(
            self._header(),
            _labelled("ROBOT", *self.status(), rows=1),
            _labelled("WHY", *self.reason()),
            _labelled("STOP", *self.stopping()),
            *self._keys(),  # a terminal that is too low lacks what is at the bottom
            *gap,
            *_directions(snapshot),
            *gap,
            beside(
                blocks.ranges(few),
                blocks.motion(*moving(snapshot), style=blocks.dim(snapshot.odometry)),
                blocks.pose(snapshot),
            ),
        )

    def status(self) -> tuple[str, str]:
        """Whose the robot is, whether it is armed, and what to do for it; and the style."""
        base = self.snapshot.base
        if self.is_lost or base is None or not base.fresh:
            return "not heard; waits for it, and does not move by itself when it is back", _BAD
        if self._is_stopped():
            whose = "yours, not armed" if self.is_mine else "stopped"
            return f"{whose}: see that it may move, then release the stop", _WAITS
        if not self.is_mine:
            if self.driver:
                return f"not yours: {self.driver[:20]} drives; WHY says when you may", _WAITS
            return "nobody's: press an arrow key or c to take it, then let go of all keys", _WAITS
        if base.sample.armed:
            return "yours, armed: hold an arrow key to drive", _GOOD
        reason = base.sample.reason
        arm = reason.to_do(KEYS) if reason.action == "hold_level" else "WHY says what is missing"
        return f"yours, not armed: {arm}", _WAITS

    def reason(self) -> tuple[str, str]:
        """What stops it, in a keyboard's words, the emergency stop before all else; and the style."""
        if self._is_stopped() or self.why.action == "release":
            return "the emergency stop, as below", _WAITS
        return (self.why.line(KEYS), _WAITS) if self.why else ("nothing: the robot obeys", _GOOD)

    def stopping(self) -> tuple[str, str]:
        """The emergency stop, with the way out; and the style."""
        estop = _fresh(self.snapshot.estop)
        if estop is not None and estop.engaged and self.stop != release_question(estop):
            told = self.stop or Trouble("OFF" if estop.off else "ENGAGED", "r releases it")
            return f"{msgspec.structs.replace(told, action='')}. {before_release('By', estop)}", _ALARM
        if self.stop:
            return self.stop.line(KEYS), _ALARM
        if estop is None:
            return "unknown, since base is not heard; SPACE asks for it all the same", _BAD
        return "released; SPACE engages it", _GOOD

    def _is_stopped(self) -> bool:
        """Whether base says that the emergency stop is engaged."""
        estop = self.snapshot.estop
        return estop is not None and estop.fresh and estop.sample.engaged

    def _header(self) -> RenderableType:
        snapshot = self.snapshot
        parts = [(f"giraff drive · {self.robot[:24]} · {clock(self.elapsed)}", "bold")]
        if snapshot.silence is not None and snapshot.silence > FRESH:
            return header(*parts, (f" · not heard for {snapshot.silence:.0f} s", _ALARM))
        if snapshot.battery is not None and snapshot.battery.fresh:
            parts.append((f" · battery {snapshot.battery.sample.voltage:.1f} V", "bold"))
        base = snapshot.base
        if base is not None and base.fresh and base.sample.round_trip is not None:
            parts.append((f" · command {base.sample.round_trip * 1000.0:.0f} ms old", "bold"))
        return header(*parts)

    def _keys(self) -> Iterator[RenderableType]:
        linear, angular = self.speed
        speed = f"{self.step}/{self.steps}: {linear:.2f} m/s, {angular:.2f} rad/s"
        rows = (  # a terminal that is too narrow lacks what is on the right
            (("SPACE", "stops"), ("r", "releases the stop"), ("← ↑ ↓ →", "or w a s d, held, drive")),
            (("Ctrl-C", "ends"), ("c", "takes it, stands"), ("+ -", f"speed {speed}")),
        )
        for number, row in enumerate(rows):
            text = Text(no_wrap=True, overflow="ellipsis")
            text.append(f"{'KEYS' if number == 0 else '':<{_LABEL}}", style=HEADING)
            for key, does in row:
                text.append(f"{key} ", style="bold").append(f"{does}   ")
            text.rstrip()
            yield text


def _labelled(label: str, text: str, style: str, rows: int = _ROWS_OF_A_TEXT) -> Paragraph:
    return Paragraph(Text(f"{label:<{_LABEL}}", style=HEADING), text, style, rows, _LABEL)


def _directions(snapshot: Snapshot) -> Iterator[Paragraph]:
    """What the guard allows in each, with its whole reason."""
    seen = snapshot.guard
    for number, label in enumerate(DIRECTIONS):
        head, why = Text.assemble((f"{label:<{_DIRECTION}}", "dim")), "the guard is not heard"
        if seen is not None and seen.fresh:
            verdict = verdicts(seen.sample)[number][1]
            head.append(f"{verdict.clearance:<8}", style=blocks.CLEARANCE_STYLE[verdict.clearance])
            unit = "rad/s" if label.startswith("turn") else "m/s"
            head.append(f"{verdict.allowed:.2f} {unit:<6}", style="default")
            why = verdict.reason.line(KEYS)
        yield Paragraph(head, why, "default", _ROWS_OF_A_DIRECTION, _DIRECTION, low_rows=1)


class DriveView:
    """Collects what a person who drives is shown. Times are monotonic, s."""

    topics: tuple[Topic[Any], ...] = (BASE, GUARD, ESTOP, BATTERY, ODOM, *SENSED.values())

    def __init__(self, robot: str, sensors: Mapping[str, str]) -> None:
        """`sensors`: types of the robot's, by name, in the order of its file."""
        self._robot = robot
        self._telemetry = Telemetry(sensors)
        self.on_sample = self._telemetry.add
        self._began: float | None = None

    def draw(self, policy: KeyboardPolicy, stop: Trouble, now: float) -> DrivePicture:
        """What is to be seen now. `stop`: what became of a stop, or of its release, that was asked for here."""
        self._began = now if self._began is None else self._began
        snapshot = self._telemetry.snapshot(_ns(now))
        return DrivePicture(
            robot=self._robot,
            elapsed=now - self._began,
            snapshot=snapshot,
            is_lost=policy.moment(now) is None,
            is_mine=policy.operator.holds,
            driver=policy.operator.holder,
            why=what_stops(policy.trouble(now), _fresh(snapshot.base), _fresh(snapshot.guard))
            or policy.operator.rank_notice,
            stop=stop,
            step=policy.step,
            steps=policy.steps,
            speed=policy.speed,
        )


def _fresh(seen: Latest[SampleT] | None) -> SampleT | None:
    return seen.sample if seen is not None and seen.fresh else None


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
