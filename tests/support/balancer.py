"""A robot that balances on the bench: its board, its simulated body, a host and a person."""

import math
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_schemas.boards import BALANCER_BOARD
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import Frame
from giraff_schemas.wires.balancer import (
    BalanceAsk,
    BalanceDriveFrame,
    BalanceEngage,
    BalanceEstopFrame,
    BalanceFlag,
    BalanceFrame,
    BalancePosture,
    BalanceSide,
)
from giraff_sim.board import Implementation, open_board
from giraff_sim.bodies.balancer.body import BalancerBody
from giraff_sim.bodies.balancer.drawn import draw
from giraff_sim.bodies.balancer.plant import Plant
from giraff_sim.world.room import Pose, Room
from tests.support.balancer_file import DRIVE, ROBOT

PROTOTYPE: Final = msgspec.structs.replace(DRIVE, k3=0.0, k4=0.0)
"""It goes by its lean alone, as the source's LEGO robot."""
HANDLE: Final = 0.8
"""m above the axle, where a person pushes."""
_FRAME_MS: Final = 20
_TRACK_MS: Final = 5
_OFF_ROWS: Final = 40  # a robot that stands still gets nothing for less
_PATIENCE_MS: Final = 8000
_POSTURES: Final = {posture.value: posture for posture in BalancePosture}


class Row(NamedTuple):
    """True values at one instant."""

    way: float
    speed: float
    lean: float
    turned: float
    has_power: bool
    """Whether a motor gets something."""


class Track:
    """True values each 5 ms."""

    def __init__(self, plant: Plant) -> None:
        self._way = plant.way
        self.rows: list[Row] = []
        self.noticed: float | None = None
        """s from the begin until the board did not stand any more, or was held."""

    def add(self, plant: Plant, *, has_power: bool) -> None:
        self.rows.append(Row(plant.way - self._way, plant.speed, plant.lean, plant.turned, has_power))

    @property
    def off(self) -> float:
        """s from the begin until the motors got nothing any more; infinite while they do."""
        powered = [number for number, row in enumerate(self.rows, 1) if row.has_power]
        last = powered[-1] if powered else 0
        return last * _TRACK_MS / 1000 if last + _OFF_ROWS <= len(self.rows) else math.inf

    def figures(self, side: float = 1.0) -> dict[str, float]:
        """Return what tests judge. `side`: 1.0 for forward, -1.0 for backward, as it was pushed or driven."""
        way, speed, lean, turned, _ = np.array(self.rows).T
        way, speed = way * side, speed * side
        last = int(1000 / _TRACK_MS)
        return {
            "sd": math.degrees(lean.std()),
            "lean": math.degrees(np.abs(lean).max()),
            "span": float(np.ptp(way)),
            "away": float(way.max()),
            "way": float(np.abs(way).max()),
            "gone": float(way[-1]),
            "back": float(way.max() - way[way.argmax() :].min()),
            "back_speed": float(-speed.min()),
            "last_speed": float(abs(speed[-last:].mean())),
            "turned": math.degrees(np.ptp(turned)),
            "off": self.off,
            "noticed": math.inf if self.noticed is None else self.noticed,
        }


class Balancer:
    """A drawn robot. A person holds it upright until its motors have power."""

    def __init__(self, seed: int, drive: BalancerConfig = DRIVE, **fixed: Any) -> None:
        self.drive_config = drive
        self.board = open_board(BALANCER_BOARD, Implementation.HOST)
        drawn = draw(drive, ROBOT.track_width, seed, **fixed)
        self.body = BalancerBody(ROBOT, drive, Room("empty", Pose(0.0, 0.0, 0.0)), seed, drawn)
        self.plant = self.body.plant
        self.plant.loads.grip = math.radians(np.random.default_rng(seed + 5).uniform(-1.0, 1.0))
        self.plant.lean_to(self.plant.loads.grip)
        self.report: BalanceFrame | None = None
        self.late = 0
        """Control periods that began late."""
        self.causes: list[int] = []
        """Each cause that the board gave, in order."""
        self.flags = 0
        """All flags that it has shown."""
        self.linear = self.angular = 0.0
        self.ask = BalanceAsk.KEEP
        self.free_side = BalanceSide.FORWARD
        self.is_silent = False
        """Whether the host sends nothing any more."""
        self.before_each_ms: Callable[[], None] = lambda: None
        self.session = 7
        """Another one makes the host tell the board `drive_config` anew."""
        self._now_ms = 0
        self._seq = 0
        self._decoder = Decoder(BALANCER_BOARD.frames)

    def close(self) -> None:
        self.board.close()

    @property
    def posture(self) -> BalancePosture:
        return BalancePosture.OFF if self.report is None else _POSTURES[self.report.posture]

    @property
    def stands(self) -> bool:
        return self.posture is BalancePosture.STANDS

    def run(self, seconds: float) -> Track:
        """Let time pass and return what the robot truly did."""
        track, motors, began_ms = Track(self.plant), self.board.model.motor, self._now_ms
        for millisecond in range(1, round(seconds * 1000) + 1):
            self.step()
            if millisecond % _TRACK_MS == 0:
                track.add(self.plant, has_power=motors[0].drive != 0.0 or motors[1].drive != 0.0)
            report = self.report
            if track.noticed is None and report is not None:
                is_well = report.posture == BalancePosture.STANDS and not report.flags & BalanceFlag.HELD
                if not is_well and (at := report.board_us / 1e6 - began_ms / 1e3) > 0.0:
                    track.noticed = at
        return track

    def stand(self, settle: float) -> None:
        """Ask it to stand, let it go, and give it time to settle."""
        for _ in range(_PATIENCE_MS):
            if self.stands and not self.body.raises_it:
                break
            is_upright = self.report is not None and self.report.flags & BalanceFlag.UPRIGHT
            self.ask = BalanceAsk.STAND if is_upright else BalanceAsk.KEEP
            self.step()
        assert self.stands, f"it does not stand up: {self.report}"
        self.ask = BalanceAsk.KEEP
        self.run(settle)

    def engage(self, how: BalanceEngage = BalanceEngage.STANDS) -> None:
        """Press the emergency stop."""
        assert self.report is not None
        self._send(
            BalanceEstopFrame(
                seq=0,
                boot_id=self.report.boot_id,
                board_ms=self.report.board_ms,
                session=self.session,
                engage=how,
            )
        )

    def sit(self, side: float) -> None:
        """Ask it to sit down, forward with 1.0 and backward with -1.0."""
        self.free_side = BalanceSide.FORWARD if side > 0.0 else BalanceSide.BACKWARD
        self.ask = BalanceAsk.SIT

    def step(self) -> None:
        """Let a millisecond pass. tests/support/budget.py counts it."""
        self.before_each_ms()
        self._now_ms += 1
        self.body.step(self.board, 0.001)
        self.board.run(self._now_ms * 1000)
        self.body.update(self.board)
        for frame in self._decoder.feed(self.board.read()):
            if isinstance(frame, BalanceFrame):
                self._hear(frame)
        if self._now_ms % _FRAME_MS == 0 and not self.is_silent and self.report is not None:
            self._talk(self.report)

    def _hear(self, frame: BalanceFrame) -> None:
        self.report, self.late = frame, frame.late
        self.flags |= frame.flags
        if frame.cause and self.causes[-1:] != [frame.cause]:
            self.causes.append(frame.cause)

    def _talk(self, report: BalanceFrame) -> None:
        if report.session != self.session:
            settings = self.drive_config.board_settings(ROBOT)
            self._send(
                msgspec.structs.replace(
                    settings, boot_id=report.boot_id, board_ms=report.board_ms, session=self.session
                )
            )
            return
        self._seq = (self._seq + 1) & 0xFFFF
        self._send(
            BalanceDriveFrame(
                seq=self._seq,
                boot_id=report.boot_id,
                board_ms=report.board_ms,
                linear_um_s=round(self.linear * 1e6),
                angular_urad_s=round(self.angular * 1e6),
                ask=self.ask,
                free_side=self.free_side,
            )
        )

    def _send(self, frame: Frame) -> None:
        data = encode(frame.pack())
        assert self.board.write(data) == len(data)
