"""The contract of every kind of drive, whatever its board says and understands.

Each kind is tested by a subclass of `AnyDrive`, with its configuration and a model of its board. A subclass may add
tests. It must not weaken one: what is unsafe for one kind is unsafe for all.
"""

from typing import ClassVar, Protocol

import msgspec
import pytest

from giraff_base.config import DriveConfig
from giraff_base.drive import Answer, Drive, Report
from giraff_base.registry import drive_of
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.trouble import NO_TROUBLE
from giraff_schemas.wire import Frame, HelloFrame, HelloRequestFrame
from tests.support import robots

SESSION = 77
SETTLED = 20
"""Reports within which a sound board is settled."""
ARMS = 5
"""Reports through which a hand is held level to arm."""


class ModelBoard(Protocol):
    """The board that a kind of drive speaks with."""

    period_ns: int
    """Time between two reports."""

    def report(self) -> Frame:
        """Go on for one period, and return the report at its end."""
        ...

    def receive(self, frame: Frame) -> None: ...

    def reset(self) -> None:
        """Reset it as its watchdog does."""
        ...

    def twist(self) -> tuple[float, float]:
        """Return how the robot truly moves, m/s and rad/s."""
        ...

    def is_safe(self) -> bool:
        """Return whether it is in its safe state, and nothing else is asked of it."""
        ...

    def is_latched(self) -> bool: ...

    def is_off(self) -> bool:
        """Return whether its motors have no power."""
        ...

    def latch_by_itself(self) -> None:
        """Latch it for a cause of its own."""
        ...


class Bench:
    """A drive and its board, with no permission between them."""

    def __init__(self, drive: Drive, board: ModelBoard) -> None:
        self.drive, self.board = drive, board
        self.now = RobotTime(epoch=7, robot_ns=10**12)
        self.engaged = False
        """Whether base's emergency stop is."""
        self._level = 0
        drive.open(SESSION)

    def hear(self) -> Report:
        """Take the board's next report."""
        self.now = RobotTime(epoch=7, robot_ns=self.now.robot_ns + self.board.period_ns)
        report = self.drive.on_frame(self.board.report(), self.now)
        assert report is not None
        is_level = not (report.disarms or report.latched or self.engaged or self.drive.arming_block)
        self._level = self._level + 1 if is_level else 0
        return report

    def ask(self, linear: float = 0.0, angular: float = 0.0, *, armed: bool | None = None) -> Answer:
        """Return what the drive answers. `armed`: where it is not given, a hand that is level arms it."""
        is_armed = self._level > ARMS if armed is None else armed
        return self.drive.ask(linear, angular, armed=is_armed, free_side="none")

    def answer(self, linear: float = 0.0, angular: float = 0.0) -> Answer:
        """Return what base would send now."""
        return self.drive.settle(self.now, engaged=self.engaged) or self.ask(linear, angular)

    def step(self, linear: float = 0.0, angular: float = 0.0) -> Report:
        report = self.hear()
        if (frame := self.answer(linear, angular).frame) is not None:
            self.board.receive(frame)
        return report

    def run(self, linear: float = 0.0, angular: float = 0.0, reports: int = SETTLED) -> None:
        for _ in range(reports):
            self.step(linear, angular)


class AnyDrive:
    """Subclass it once for each kind and configuration."""

    config: ClassVar[DriveConfig]
    robot: ClassVar[RobotConfig] = robots.ROBOT
    command_timeout: ClassVar[float]
    """s without a frame, after which the board goes to its safe state by itself."""

    def board(self) -> ModelBoard:
        raise TypeError("each kind gives its board")

    def bench(self) -> Bench:
        """Return a drive that has just opened its port."""
        base = msgspec.structs.replace(robots.BASE, drive=self.config)
        return Bench(drive_of(self.robot, base), self.board())

    def settled(self) -> Bench:
        """Return one that has nothing left to settle, and whose board is ready."""
        bench = self.bench()
        bench.run()
        bench.hear()
        assert bench.drive.settle(bench.now, engaged=False) is None
        assert bench.drive.not_ready == NO_TROUBLE
        return bench

    def moving(self, linear: float = 0.3, angular: float = 0.0) -> Bench:
        bench = self.settled()
        bench.run(linear, angular, reports=50)
        return bench

    def test_nothing_moves_before_the_session_is_settled(self) -> None:
        bench = self.bench()
        for _ in range(SETTLED):
            report = bench.hear()
            settling = bench.drive.settle(bench.now, engaged=False)
            if settling is None:
                return
            assert report.samples == ()
            assert not settling.moves
            assert settling.reason
            if settling.frame is not None:
                bench.board.receive(settling.frame)
            assert bench.board.is_safe()
        raise AssertionError("it is never settled")

    def test_its_samples_are_of_its_topics(self) -> None:
        bench = self.settled()
        samples = bench.hear().samples
        assert samples
        assert {type(sample) for sample in samples} <= {topic.schema for topic in bench.drive.topics}

    def test_its_board_knows_what_it_reports_and_what_it_is_sent(self) -> None:
        bench, frames = self.settled(), self.config.board_type.frames.values()
        asked = bench.ask(0.1, 0.0).frame
        assert {type(bench.board.report()), type(asked), HelloFrame, HelloRequestFrame} <= set(frames)

    def test_it_moves_as_it_is_asked_and_tells_so(self) -> None:
        bench = self.moving(0.3, 0.4)
        assert bench.board.twist() == pytest.approx((0.3, 0.4), rel=0.05)
        [told] = [sample for sample in bench.hear().samples if isinstance(sample, Wheels)]
        twist = self.robot.kinematics.twist(told.left_velocity, told.right_velocity)
        assert twist == pytest.approx((0.3, 0.4), rel=0.05)

    def test_a_frame_that_was_held_up_moves_nothing(self) -> None:
        bench = self.settled()
        late = bench.ask(0.3, 0.0)
        assert late.moves
        assert late.frame is not None
        for _ in range(round(0.2e9 / bench.board.period_ns)):
            bench.hear()
        bench.board.receive(late.frame)
        assert bench.board.is_safe()

    def test_a_board_that_hears_nothing_is_safe_within_its_timeout(self) -> None:
        bench = self.moving()
        assert not bench.board.is_safe()
        for _ in range(round(self.command_timeout * 1e9 / bench.board.period_ns) + 1):
            bench.hear()
        assert bench.board.is_safe()
        assert bench.drive.not_ready

    def test_an_engaged_stop_latches_the_board_whatever_is_under_way(self) -> None:
        bench = self.moving()
        bench.engaged = True
        bench.step(0.3)
        bench.drive.release()
        bench.drive.hold(off=False)  # another engaging overtakes the release
        for _ in range(SETTLED):
            bench.step(0.3)
            assert bench.board.is_latched()
            assert bench.board.is_safe()

    def test_off_comes_under_an_engaged_stop_too_and_outlasts_the_port(self) -> None:
        bench = self.moving()
        bench.engaged = True
        bench.drive.hold(off=False)
        bench.run()
        bench.drive.hold(off=bench.drive.can_power_off)
        bench.run()
        assert bench.board.is_off()
        bench.board = self.board()
        bench.drive.open(SESSION + 1)
        bench.run()
        assert bench.board.is_latched()
        assert bench.board.is_off()

    def test_an_engaged_stop_waits_for_no_session(self) -> None:
        bench = self.bench()
        bench.engaged = True
        bench.step()
        assert bench.board.is_latched()

    def test_a_port_that_is_opened_again_is_settled_anew(self) -> None:
        bench = self.moving()
        bench.drive.open(SESSION + 1)
        assert not bench.drive.state().connected
        assert bench.drive.at_rest, "of the new port there is no report"
        assert bench.hear().samples == (), "the session is one of the earlier port"
        assert bench.drive.settle(bench.now, engaged=False) is not None

    def test_a_latch_is_released_by_a_release_alone_and_that_moves_nothing(self) -> None:
        bench = self.settled()
        bench.engaged = True
        bench.step()
        bench.engaged = False
        bench.run(0.3)
        assert bench.board.is_latched()
        bench.drive.release()
        bench.run()
        assert not bench.board.is_latched()
        assert bench.board.is_safe()
        bench.board.latch_by_itself()
        assert bench.hear().latched is not None, "the release has reached the board, and is over"

    def test_the_boards_own_latch_is_told_with_its_remedy(self) -> None:
        bench = self.settled()
        bench.board.latch_by_itself()
        told = bench.hear().latched
        assert told is not None
        assert told.reason.remedy
        bench.drive.release()
        assert bench.hear().latched is None, "its release is under way"

    def test_a_reset_board_disarms_and_is_settled_anew(self) -> None:
        bench = self.moving()
        bench.board.reset()
        assert bench.hear().disarms
        assert bench.drive.settle(bench.now, engaged=False) is not None
        assert bench.board.is_safe()

    def test_a_board_that_is_reset_under_a_release_is_stopped_again(self) -> None:
        bench = self.settled()
        bench.engaged = True
        bench.step()
        bench.engaged = False
        bench.drive.release()
        bench.board.reset()
        assert bench.hear().latched is not None

    def test_another_session_disarms(self) -> None:
        ours, theirs = self.settled(), self.bench()
        theirs.board = ours.board
        theirs.drive.open(SESSION + 1)
        theirs.run()
        assert ours.hear().disarms
        assert ours.drive.settle(ours.now, engaged=False) is not None

    def test_zero_asks_for_the_safe_state(self) -> None:
        bench = self.moving()
        asked = bench.ask(0.0, 0.0)
        assert asked.frame is not None
        assert not asked.moves
        bench.board.receive(asked.frame)
        assert bench.board.is_safe()

    def test_no_twist_is_beyond_the_board(self) -> None:
        for linear, angular in ((3.0, 0.0), (-3.0, 0.0), (0.0, 9.0), (2.0, -9.0)):
            bench = self.moving(linear, angular)
            assert bench.drive.state().last_refusal == "none"
            assert not bench.board.is_safe()

    def test_it_is_at_rest_only_where_it_stands_in_its_safe_state(self) -> None:
        assert self.bench().drive.at_rest, "before any report"
        bench = self.settled()
        bench.run()
        assert bench.drive.at_rest
        bench = self.moving()
        assert not bench.drive.at_rest
        bench.step()
        bench.hear()
        assert not bench.drive.at_rest, "in its safe state it still rolls"

    def test_a_lost_board_tells_nothing(self) -> None:
        bench = self.settled()
        assert bench.drive.state().connected
        bench.drive.lose()
        assert not bench.drive.state().connected
        assert bench.drive.voltage is None
        bench.board.latch_by_itself()
        bench.hear()
        bench.drive.release()
        bench.drive.lose()
        assert bench.hear().latched is not None, "a release is of the board that there was"
