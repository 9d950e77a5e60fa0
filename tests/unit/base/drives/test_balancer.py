"""The contract of a robot that balances, and what is its own: when it may get up, and what makes it go off."""

from typing import Any

import msgspec
import pytest

from giraff_base.drives.balancer.words import HELD, ONLY_STANDS
from giraff_base.policy import BasePolicy
from giraff_core.estop.latch import RELEASED
from giraff_core.live import Live
from giraff_schemas.messages import Attitude, RobotTime, Side, Wheels
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, ECHO_MAX_AGE_MS, DriveState, Frame, Refusal
from giraff_schemas.wires.balancer import (
    BALANCE_REPORT_MS,
    PROTOCOL_HASH,
    BalanceAsk,
    BalanceCause,
    BalanceConfigureFrame,
    BalanceDriveFrame,
    BalanceEngage,
    BalanceEstopFrame,
    BalanceFlag,
    BalanceFrame,
    BalanceLatch,
    BalancePosture,
    BalanceSide,
)
from tests.support import robots
from tests.support.balancer_file import DRIVE, ROBOT
from tests.unit.base.drives.contract import SESSION, SETTLED, AnyDrive, Bench

_SHARE = BALANCE_REPORT_MS / 100  # of a speed's way to what is asked, in one report


class BalancerBoard:
    """Keeps balancer_protocol.h. A person holds it upright and still."""

    period_ns = BALANCE_REPORT_MS * 1_000_000

    def __init__(self) -> None:
        self.boot_id, self.session, self.sent = 1, 0, 0
        self.board_ms = 0xFFFFFFFF - 2000
        self.posture, self.cause = BalancePosture.OFF, BalanceCause.NONE
        self.drive_state, self.latch, self.refusal = DriveState.NOT_CONFIGURED, BalanceLatch.NONE, Refusal.NONE
        self.flags = BalanceFlag.UPRIGHT
        self.lean = 20_000
        self.settings: BalanceConfigureFrame | None = None
        self.asked = self.moves = 0.0, 0.0
        self.free_side = BalanceSide.NONE
        self._may_stand, self._off_ms = False, self.board_ms
        self._left_ms, self._seq = 0, -1

    def report(self) -> BalanceFrame:
        self.board_ms = (self.board_ms + BALANCE_REPORT_MS) & 0xFFFFFFFF
        self._left_ms -= BALANCE_REPORT_MS
        if self.drive_state == DriveState.ACTIVE and self._left_ms <= 0:
            self.drive_state, self.asked = DriveState.COMMAND_TIMEOUT, (0.0, 0.0)
        now, asked = self.moves, self.asked
        self.moves = now[0] + _SHARE * (asked[0] - now[0]), now[1] + _SHARE * (asked[1] - now[1])
        self.sent += 1
        fields: dict[str, Any] = dict.fromkeys(BalanceFrame.__struct_fields__, 0)
        fields |= {
            "seq": self.sent & 0xFFFF,
            "board_ms": self.board_ms,
            "boot_id": self.boot_id,
            "session": self.session,
            "lean_urad": self.lean,
            "speed_um_s": round(self.moves[0] * 1e6),
            "turn_urad_s": round(self.moves[1] * 1e6),
            "left_command": -127,
            "battery_mv": 12_300,
            "posture": self.posture,
            "cause": self.cause,
            "flags": self.flags,
            "drive_state": self.drive_state,
            "latch": self.latch,
            "last_refusal": self.refusal,
        }
        return BalanceFrame(**fields)

    def receive(self, frame: Frame) -> None:
        if isinstance(frame, BalanceEstopFrame):
            self._estop(frame)
        elif isinstance(frame, BalanceConfigureFrame):
            is_ours = (frame.protocol_hash, frame.boot_id) == (PROTOCOL_HASH, self.boot_id)
            self.refusal = Refusal.NONE if is_ours else Refusal.PROTOCOL
            if is_ours:
                self.settings, self.session, self._seq = frame, frame.session, -1
                self.drive_state = DriveState.LATCHED if self.latch else DriveState.AWAITING_ZERO
                self.asked = 0.0, 0.0
        elif isinstance(frame, BalanceDriveFrame) and (refusal := self._drive(frame)) != Refusal.NONE:
            self.refusal = refusal

    def reset(self) -> None:
        self.boot_id += 1
        self.session, self.board_ms, self.refusal = 0, 0, Refusal.NONE
        self.drive_state = DriveState.LATCHED if self.latch else DriveState.NOT_CONFIGURED
        self.go_off(BalanceCause.NONE)

    def go_off(self, cause: BalanceCause) -> None:
        self.posture, self.cause, self.asked = BalancePosture.OFF, cause, (0.0, 0.0)
        self._may_stand, self._off_ms = False, self.board_ms

    def twist(self) -> tuple[float, float]:
        return self.moves

    def is_safe(self) -> bool:
        return self.asked == (0.0, 0.0)

    def is_latched(self) -> bool:
        return self.latch != BalanceLatch.NONE

    def is_off(self) -> bool:
        return self.posture == BalancePosture.OFF

    def latch_by_itself(self) -> None:
        """Find a latch in its EEPROM after a reset: it never latches for a cause of its own."""
        self.latch = BalanceLatch.STANDS
        self.reset()

    def _estop(self, frame: BalanceEstopFrame) -> None:
        if frame.engage != BalanceEngage.RELEASE:
            engaged = BalanceLatch.STANDS if frame.engage == BalanceEngage.STANDS else BalanceLatch.OFF
            self.latch, self.drive_state, self.asked = max(self.latch, engaged), DriveState.LATCHED, (0.0, 0.0)
            if self.latch == BalanceLatch.OFF and not self.is_off():
                self.go_off(BalanceCause.ESTOP_OFF)
        elif self.latch and (frame.boot_id, frame.session) == (self.boot_id, self.session):
            self.latch, self.drive_state = BalanceLatch.NONE, DriveState.AWAITING_ZERO

    def _drive(self, frame: BalanceDriveFrame) -> Refusal:
        settings, asked = self.settings, (frame.linear_um_s * 1e-6, frame.angular_urad_s * 1e-6)
        if frame.boot_id != self.boot_id or not self.session or settings is None:
            return Refusal.NOT_CONFIGURED
        is_new = self._seq < 0 or 0 < (frame.seq - self._seq) & 0xFFFF < 0x8000
        is_fresh = is_new and (self.board_ms - frame.board_ms) & 0xFFFFFFFF <= ECHO_MAX_AGE_MS
        most = settings.speed_max_mm_s / 1000, settings.turn_max_mrad_s / 1000
        if not is_fresh or abs(asked[0]) > most[0] or abs(asked[1]) > most[1]:
            return Refusal.LEVEL if is_fresh else Refusal.STALE
        self._seq = frame.seq
        if self.latch:
            return Refusal.LATCHED
        if asked != (0.0, 0.0) and self.drive_state != DriveState.ACTIVE:
            return Refusal.AWAITING_ZERO
        self.drive_state, self._left_ms = DriveState.ACTIVE, COMMAND_TIMEOUT_MS
        self.free_side = BalanceSide(frame.free_side)
        if self.is_off():
            if frame.ask == BalanceAsk.KEEP and frame.board_ms != self._off_ms:
                self._may_stand = True
            if frame.ask == BalanceAsk.STAND and self._may_stand and self.flags & BalanceFlag.UPRIGHT:
                self.posture, self.cause = BalancePosture.STANDS, BalanceCause.NONE
        self.asked = (0.0, 0.0) if self.is_off() else asked
        return Refusal.NONE


class TestBalancer(AnyDrive):
    config = DRIVE
    robot = ROBOT
    command_timeout = COMMAND_TIMEOUT_MS / 1000

    def board(self) -> BalancerBoard:
        return BalancerBoard()

    def board_of(self, bench: Bench) -> BalancerBoard:
        assert isinstance(bench.board, BalancerBoard)
        return bench.board

    def test_it_gets_up_only_when_it_is_armed(self) -> None:
        bench = self.bench()
        for _ in range(SETTLED):
            bench.hear()
            answer = bench.drive.settle(bench.now, engaged=False) or bench.ask(armed=False)
            if answer.frame is not None:
                bench.board.receive(answer.frame)
        assert bench.board.is_off()
        assert bench.drive.arming_block == Trouble()
        assert str(bench.drive.not_ready) == "the robot gets up"
        bench.run()
        assert not bench.board.is_off()

    def test_while_it_lies_nobody_arms_it_and_it_is_told_what_to_do(self) -> None:
        bench = self.bench()
        board = self.board_of(bench)
        board.flags = BalanceFlag(0)
        assert bench.drive.arming_block, "before any report"
        bench.run()
        lies = Trouble("the robot is off and not upright", "hold it upright and still")
        assert (bench.drive.arming_block, bench.drive.not_ready) == (lies, lies)
        board.flags = BalanceFlag.UPRIGHT
        bench.run()
        assert not bench.drive.arming_block
        assert not board.is_off()

    @pytest.mark.parametrize("cause", [cause for cause in BalanceCause if cause != BalanceCause.NONE])
    def test_what_ends_standing_disarms_and_says_why(self, cause: BalanceCause) -> None:
        for posture, told in ((BalancePosture.OFF, "it went off: "), (BalancePosture.SITS_DOWN, "it sat down: ")):
            bench = self.moving()
            board = self.board_of(bench)
            board.go_off(cause)
            board.posture = posture
            [why] = bench.hear().disarms
            assert why.what.startswith(told)
            assert "cause" not in why.what, "it has words"
            assert not bench.hear().disarms, "once"
            assert bench.drive.arming_block
            board.posture, board.flags = BalancePosture.OFF, BalanceFlag(0)
            bench.hear()
            assert bench.drive.arming_block.what.startswith("the robot is off: ")
            assert bench.drive.arming_block.remedy.endswith("hold it upright and still")

    @pytest.mark.parametrize("how", ["fault", "reset", "port"])
    def test_where_it_went_off_it_gets_up_only_after_a_hand_has_leaned_it(self, how: str) -> None:
        """Without power it often stands on its friction, upright and still: nobody may have a hand on it."""
        bench = self.moving()
        board = self.board_of(bench)
        if how == "port":
            bench.drive.open(SESSION + 1)
        if how == "fault":
            board.go_off(BalanceCause.LEFT_ENCODER)
        else:
            board.reset()
        bench.run(reports=3 * SETTLED)
        assert board.is_off()
        assert "lean it once" in bench.drive.arming_block.remedy
        board.lean = -110_000
        bench.step()
        board.lean = 20_000
        bench.run(reports=2 * SETTLED)
        assert not board.is_off()

    def test_it_is_not_at_rest_from_when_it_is_asked_to_move(self) -> None:
        bench = self.settled()
        bench.ask(0.3)
        assert not bench.drive.at_rest, "it does not move yet"

    def test_what_held_it_disarms(self) -> None:
        bench = self.moving()
        self.board_of(bench).flags |= BalanceFlag.HELD
        assert bench.hear().disarms == (HELD,)

    def test_a_pulled_cord_is_an_emergency_stop_that_is_off(self) -> None:
        bench = self.moving()
        self.board_of(bench).flags |= BalanceFlag.CORD
        told = bench.hear().latched
        assert told is not None
        assert (told.by, told.off) == ("the cord", True)
        bench.drive.release()
        assert bench.hear().latched is not None, "while it is pulled, no release ends that"

    @pytest.mark.parametrize(("latch", "off"), [(BalanceLatch.STANDS, False), (BalanceLatch.OFF, True), (9, True)])
    def test_a_latch_that_the_board_has_kept_is_off_where_it_was(self, latch: Any, off: bool) -> None:
        bench = self.settled()
        board = self.board_of(bench)
        board.latch = latch
        told = bench.hear().latched
        assert told is not None
        assert told.off == off

    @pytest.mark.parametrize(
        ("side", "wired"),
        [("none", BalanceSide.NONE), ("forward", BalanceSide.FORWARD), ("backward", BalanceSide.BACKWARD)],
    )
    def test_each_frame_says_where_it_may_sit_down(self, side: Side, wired: BalanceSide) -> None:
        bench = self.settled()
        frame = bench.drive.ask(0.1, 0.0, armed=True, free_side=side).frame
        assert isinstance(frame, BalanceDriveFrame)
        assert frame.free_side == wired

    def test_a_limit_is_named_while_it_drives(self) -> None:
        bench = self.settled()
        self.board_of(bench).flags |= BalanceFlag.AT_LIMIT
        bench.hear()
        assert bench.ask(0.2).reason
        assert bench.ask().reason is None

    def test_its_samples_are_the_report(self) -> None:
        bench = self.moving(0.2)
        wheels, attitude = bench.hear().samples
        assert isinstance(wheels, Wheels)
        assert wheels.left_pwm_counts == -255
        assert isinstance(attitude, Attitude)
        assert (attitude.lean, attitude.posture, attitude.cause) == (0.02, "stands", "")
        assert bench.drive.voltage == 12.3

    def test_its_board_gets_the_physics_of_its_file(self) -> None:
        settings = self.config.board_settings(self.robot)
        assert settings.gravity_mnm_rad == pytest.approx(34 * 9.81 * 0.246 * 1000, abs=1)
        assert settings.momentum_gms == pytest.approx((38.8 * 0.175 + 34 * 0.246 + 0.09 / 0.175) * 1000, abs=1)
        assert settings.momentum_gm2 == pytest.approx((34 * 0.246 * 0.421 + 3.4) * 1000, abs=1)
        assert settings.pack()

    @pytest.mark.parametrize(
        ("fields", "told"),
        [
            ({"k3": 0.0}, "either both are 0, or none is"),
            ({"k1": 0.0}, "the robot falls with k1 0, .* `giraff tune balance` computes others"),
            ({"k1": 150.0}, r"with a quarter or 3\.5 times as much, or with the play of its gears: raise k1 to"),
            ({"k2": 30.0}, "raise k2 to"),
            ({"k4": 1500.0}, "lower k4 to"),
            ({"k1": 300.0}, r"raise k1 to 594\.7 or more$"),
            ({"k1": 2000.0}, "lower k1 to 1439 or less$"),
            ({"k1": 1400.0}, r"the robot runs on by 0\.22 m before it stands"),
            ({"k3": 0.0, "k4": 0.0, "k1": 82.0}, "raise k1 to"),
            ({"torque_max": 30.0}, r"torque_max is 30 N m: it must be above 30\.7"),
            ({"battery_minimum": 9.9}, "they must rise"),
            ({"battery_nominal": 10.0}, "they must rise"),
        ],
    )
    def test_settings_that_contradict_each_other_are_refused(self, fields: dict[str, float], told: str) -> None:
        with pytest.raises(ValueError, match=told):
            msgspec.structs.replace(DRIVE, **fields)

    def test_new_gains_count_once_the_board_proves_that_it_has_them(self) -> None:
        bench = self.moving()
        board = self.board_of(bench)
        bench.drive.reconfigure(msgspec.structs.replace(DRIVE, k1=1200.0))
        waits = 0
        while (unproved := bench.drive.settle(bench.now, engaged=False)) is None:
            assert not bench.step(0.3).disarms
            assert board.is_safe(), "it stops by the gains that it has"
            waits += 1
        assert waits > 50, "it has stood for half a second"
        assert (bench.drive.arming_block, board.is_off()) == (Trouble(), False)
        assert bench.hear().samples, "they are of the same robot"
        assert not unproved.moves, "nothing drives by gains that the board may not have"
        bench.run()
        bench.run(0.3, reports=100)
        assert board.settings is not None
        assert (board.session, board.settings.k1_mnm_rad) == (SESSION + 1, 1_200_000)
        assert board.twist()[0] == pytest.approx(0.0, abs=0.001)
        assert bench.ask(0.3).reason == ONLY_STANDS
        assert not bench.hear().disarms
        bench.drive.reconfigure(msgspec.structs.replace(DRIVE, k1=1200.0))
        bench.hear()
        assert bench.drive.settle(bench.now, engaged=False) is None, "the board has them already"
        bench.drive.reconfigure(DRIVE)
        bench.run(reports=60)
        bench.run(0.3, reports=100)
        assert board.twist()[0] == pytest.approx(0.3, abs=0.001), "it drives by the gains of its file"
        theirs = self.bench()
        theirs.board = board
        theirs.drive.open(SESSION + 9)
        theirs.run()
        assert bench.hear().disarms

    @pytest.mark.parametrize(
        ("fields", "drives"),
        [
            ({}, True),
            ({"k1": 800.0}, True),
            ({"k1": 1200.0}, False),
            ({"k4": 150.0}, False),
            ({"k3": 0.0, "k4": 0.0}, False),
        ],
    )
    def test_it_drives_by_gains_with_which_it_stops_in_time(self, fields: dict[str, float], drives: bool) -> None:
        assert msgspec.structs.replace(DRIVE, **fields).drives(ROBOT) is drives

    def test_base_tells_its_board(self) -> None:
        config = msgspec.structs.replace(robots.BASE, drive=DRIVE)
        policy, board, now = BasePolicy(Live(config), ROBOT, RELEASED), BalancerBoard(), 10**12
        policy.on_link_opened(SESSION)
        policy.on_reconfigured(msgspec.structs.replace(config, drive=msgspec.structs.replace(DRIVE, k1=1200.0)))
        for _ in range(SETTLED + 60):
            now += board.period_ns
            time = RobotTime(epoch=7, robot_ns=now)
            policy.on_frames([board.report()], time)
            if (frame := policy.next_frame(time)) is not None:
                board.receive(frame)
        assert board.settings is not None
        assert (board.session, board.settings.k1_mnm_rad) == (SESSION + 1, 1_200_000)

    def test_a_wheel_that_contradicts_the_counts_is_refused(self) -> None:
        wrong = msgspec.structs.replace(ROBOT, ticks_per_metre=ROBOT.ticks_per_metre * 1.03)
        with pytest.raises(ValueError, match="give 4656 counts per metre"):
            DRIVE.require_countable(wrong)

    def test_a_robot_too_fast_for_its_motors_is_refused(self) -> None:
        wrong = msgspec.structs.replace(ROBOT, max_wheel_speed=0.54)
        with pytest.raises(ValueError, match=r"makes 1\.08 m/s, and must have 50% of it left"):
            DRIVE.require_countable(wrong)
        msgspec.structs.replace(DRIVE, battery_nominal=24.0).require_countable(wrong)
