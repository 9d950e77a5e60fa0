"""Whatever happens in whatever order: the robot moves only when armed, on fresh commands, and says why it does not."""

from collections.abc import Callable

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_base.estop import EStopLatch
from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.requests import EStopEngage, EStopReset
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import DriveFrame, DriveState, Frame, Latch, SpeedFlag, SpeedFrame
from tests.support.robots import BY_SPEED, DRIVE
from tests.unit.base.rig import EPOCH, Board, Rig, Sent, demand

NS = 1_000_000_000
FULL, EMPTY = 800, 600
"""ADC counts of a battery at 24 and at 18 V."""


class Judge:
    """Base's rules in other words: what must be true of a frame that moves the robot."""

    def __init__(self) -> None:
        self.heard: list[tuple[int, GuardedCommand]] = []
        self.reset_ns = 0
        """The last moment after which the robot must be armed anew."""
        self.holder = ("", 0)
        self.latched = False
        self.releasing = False
        """The latch was reset, and the board has not said yet that it has heard."""
        self.clock_ns = 0
        """The moment from which the robot's clock can be trusted."""
        self._drained_ns: int | None = None
        self.empty = False
        self._armed_since: tuple[int, int] | None = None
        """The moments of a reset and of the clock since which the robot was armed."""

    def hear(self, command: GuardedCommand, now_ns: int, bound: str) -> None:
        """A new command, and whom base obeyed when it came."""
        if self.age_ns(command.guard_tick, now_ns) <= 200_000_000:
            if bound not in ("", command.instance):
                self.reset_ns = now_ns + 1  # whatever it says, it arms nothing with what came before
            elif (command.operator, command.lease_counter) != self.holder:
                self.reset_ns = now_ns
                self.holder = (command.operator, command.lease_counter)
            if command.source == "fault" or command.lease_counter == 0:
                self.reset_ns = now_ns + 1
        self.heard.append((now_ns, command))

    def see(self, board: Board, now_ns: int) -> None:
        """What a report says."""
        if board.latch == Latch.NONE:
            self.releasing = False
        elif not self.releasing:
            self.latched = True
        if board.drive_state == DriveState.HELD:
            self.reset_ns = now_ns
        if board.battery_adc_counts == FULL:
            self._drained_ns = None
            if self.empty:
                self.empty, self.reset_ns = False, now_ns
        elif self._drained_ns is None:
            self._drained_ns = now_ns
        elif now_ns - self._drained_ns >= 5 * NS:
            self.empty = True

    def age_ns(self, tick: RobotTime | None, now_ns: int) -> int:
        if tick is None or tick.epoch != EPOCH or tick.robot_ns > now_ns:
            return 10**18
        return now_ns - tick.robot_ns

    def may_drive(self, now_ns: int) -> bool:
        """Whether some command that was heard is fresh in all its parts and asks for motion, and nothing forbids it."""
        if self.latched or self.empty or now_ns < self.clock_ns:
            return False
        newest_first = reversed(self.heard)
        return any(self._fresh(command, now_ns) for heard_ns, command in newest_first if now_ns - heard_ns <= NS)

    def _fresh(self, command: GuardedCommand, now_ns: int) -> bool:
        return (
            command.source == "hand"
            and command.lease_counter != 0
            and (command.operator, command.lease_counter) == self.holder
            and not command.neutral
            and self.age_ns(command.operator_tick, now_ns) < 400_000_000
            and self.age_ns(command.guard_tick, now_ns) < 200_000_000
            and (
                command.range_tick is None
                or command.linear_x == 0.0
                or self.age_ns(command.range_tick, now_ns) <= 400_000_000
            )
        )

    def was_armed(self) -> bool:
        """Whether a hand was held neutral for 0.2 s of its own time, without a gap, since the last reset."""
        since, began, last = (self.reset_ns, self.clock_ns), None, None
        if since == self._armed_since:
            return True
        for heard_ns, command in self.heard:
            if heard_ns < max(since) or self.age_ns(command.guard_tick, heard_ns) > 200_000_000:
                continue
            tick = command.operator_tick
            if tick is None or not command.hand_neutral or self.age_ns(tick, heard_ns) > 400_000_000:
                last = None
                continue
            if last is None or not 0 <= tick.robot_ns - last <= 100_000_000:
                began = tick.robot_ns
            last = tick.robot_ns
            if began is not None and last - began >= 200_000_000:
                self._armed_since = since
                return True
        return False


class Events:
    """Anything at all happens to base, and each frame is judged."""

    def __init__(self, checked: bool, by_speed: bool) -> None:
        self.checked = checked
        drive = BY_SPEED if by_speed else DRIVE
        self.frames: type[Frame] = SpeedFrame if by_speed else DriveFrame
        self.most = 600_000 if by_speed else DRIVE.max_level
        self.rig = Rig(drive=drive if checked else msgspec.structs.replace(drive, invert_left_motor=None))
        self.judge = Judge()
        self.session = 99

    def pass_time(self, steps: int) -> None:
        for n in range(steps):
            speaks, self.rig.guard_speaks = self.rig.guard_speaks, False
            before = len(self.rig.sent)
            if self.rig.connected:
                self.judge.see(self.rig.board, self.rig.robot_ns + 10_000_000)
            self.rig.step()
            self.rig.guard_speaks = speaks
            for each in self.rig.sent[before:]:
                self.check(each)
            if speaks and n % 2 == 0:
                self.say(self.rig.command())

    def say(self, command: GuardedCommand) -> None:
        bound = self.rig.base.state().guard
        self.rig.say(command)
        self.judge.hear(command, self.rig.robot_ns, bound)

    def recover(self) -> None:
        """All is well again: nothing is latched, the hand is level, then it drives."""
        rig = self.rig
        rig.source, rig.epoch, rig.guard_speaks, rig.connected, rig.lease_counter = "hand", EPOCH, True, True, 5
        rig.operator_age, rig.guard_age, rig.range_age, rig.operator_tick = 0.03, 0.005, 0.1, None
        rig.tilt(0.0)
        if rig.board.battery_adc_counts == EMPTY:
            rig.board.battery_adc_counts = FULL
            self.pass_time(510)
        self.pass_time(110 + max(0, self.judge.clock_ns - rig.robot_ns) // 10_000_000)
        self.reset(0, 0.0)
        self.pass_time(100)
        assert rig.base.state().armed == self.checked, rig.base.state().reason
        rig.tilt(0.6, 0.5)
        self.pass_time(30)
        assert rig.sent[-1].moves == self.checked, rig.sent[-1].state.reason

    def change(self, attribute: str, value: object) -> None:
        setattr(self.rig, attribute, value)

    def freeze(self) -> None:
        self.rig.operator_tick = self.rig.ago(0.03)

    def open_again(self) -> None:
        self.session += 1
        self.rig.base.on_link_opened(self.session)
        self.judge.reset_ns = self.rig.robot_ns + 1
        self.judge.releasing = False

    def lose(self) -> None:
        self.rig.base.on_link_lost(Trouble("unplugged"))
        self.judge.reset_ns = self.rig.robot_ns + 1
        self.judge.releasing = False

    def reset_board(self) -> None:
        self.rig.board.reset()
        if self.rig.connected:
            self.judge.reset_ns = self.rig.robot_ns + 1
            self.judge.releasing = False

    def engage(self) -> None:
        self.rig.base.on_engage(EStopEngage(by="somebody", reason=Trouble("a shout")), self.rig.now)
        self.judge.latched, self.judge.releasing = True, False

    def latch_board(self, latch: Latch) -> None:
        self.rig.board.engage(latch)

    def hold_wheel(self, wheel: SpeedFlag) -> None:
        if self.rig.board.drive_state == DriveState.ACTIVE and self.frames is SpeedFrame:
            self.rig.board.hold(wheel)

    def reset(self, id_error: int, age: float) -> None:
        """Somebody asks for a reset, of the right latch or not, now or long ago."""
        base = self.rig.base
        there: EStopLatch = base.latch
        engaged_ns = base.estop().engaged_ns
        tick = RobotTime(epoch=EPOCH, robot_ns=self.rig.robot_ns - round(age * NS))
        answer = base.on_reset(EStopReset(by="somebody", id=there.id + id_error, tick=tick), self.rig.now)
        if there.engaged and id_error == 0 and 0.0 <= age <= 1.0 and tick.robot_ns >= engaged_ns:
            assert answer.done
            self.judge.latched, self.judge.releasing = False, True
            self.judge.reset_ns = self.rig.robot_ns
        assert base.latch.engaged == self.judge.latched == answer.engaged

    def drain(self) -> None:
        self.rig.board.battery_adc_counts = EMPTY
        self.pass_time(520)

    def jump(self, seconds: float) -> None:
        """The robot's clock is somewhere else at once."""
        if seconds < 0.0:
            self.judge.clock_ns = max(self.judge.clock_ns, self.rig.robot_ns + NS)
        self.rig.robot_ns += round(seconds * NS)
        self.say(self.rig.command())

    def replay(self, back: int, forged: bool) -> None:
        """Something that was heard comes again: it must count for nothing, so the judge does not hear it."""
        _, command = self.judge.heard[-min(back, len(self.judge.heard))]
        fresh = self.judge.age_ns(command.guard_tick, self.rig.robot_ns) <= 200_000_000
        if fresh and command.instance != self.rig.base.state().guard:
            self.judge.reset_ns = self.rig.robot_ns + 1
        self.rig.say(msgspec.structs.replace(command, linear_x=0.6, hand_neutral=False) if forged else command)

    def check(self, sent: Sent) -> None:
        asked = self.rig.base._permission._command
        assert sent.state.driving == sent.moves
        if sent.moves:
            assert self.checked
            assert sent.state.armed
            assert str(sent.state.reason) == "" or "slowed" in str(sent.state.reason)
            assert self.judge.may_drive(sent.robot_ns)
            assert self.judge.was_armed()
            assert sent.report.drive_state == DriveState.ACTIVE
            assert sent.report.session == self.session
        elif asked is None or not asked.neutral:
            assert sent.state.reason
        assert (sent.frame.board_ms, sent.frame.boot_id) == (sent.report.board_ms, sent.report.boot_id)
        assert isinstance(sent.frame, self.frames)
        assert max(map(abs, demand(sent.frame))) <= self.most


def changes(attribute: str, *values: object) -> st.SearchStrategy[tuple[Callable[..., None], tuple[object, ...]]]:
    return st.sampled_from([(Events.change, (attribute, value)) for value in values])


EVENTS = st.one_of(
    changes("linear", 0.0, 0.3, -0.6),
    changes("angular", 0.0, -1.5),
    changes("operator_age", 0.0, 0.25, 0.39, 0.4, 0.41, 1.1, -0.01),
    changes("guard_age", 0.0, 0.15, 0.2, 0.21, 1.1, -0.01),
    changes("range_age", 0.4, 0.41, 1.1, -0.01),
    changes("epoch", EPOCH + 1, EPOCH),
    changes("guard_speaks", False, True),
    changes("source", "fault", "hand"),
    changes("operator", "operator-1", "operator-2"),
    changes("lease_counter", 0, 5, 6),
    changes("guard", "guard-1", "guard-2"),
    changes("connected", False, True),
    st.sampled_from(
        [
            (Events.freeze, ()),
            (Events.open_again, ()),
            (Events.lose, ()),
            (Events.reset_board, ()),
            (Events.engage, ()),
            (Events.drain, ()),
            (Events.change, ("operator_tick", None)),
        ]
    ),
    st.tuples(st.just(Events.latch_board), st.tuples(st.sampled_from([each for each in Latch if each]))),
    st.tuples(st.just(Events.hold_wheel), st.tuples(st.sampled_from([SpeedFlag.LEFT_HELD, SpeedFlag.RIGHT_HELD]))),
    st.tuples(st.just(Events.reset), st.tuples(st.sampled_from([0, 1, -1]), st.sampled_from([0.0, 1.0, 1.01, 8.0]))),
    st.tuples(st.just(Events.jump), st.tuples(st.sampled_from([-2.0, -0.3, -0.01, 0.3, 3.0, 3600.0]))),
    st.tuples(st.just(Events.replay), st.tuples(st.integers(1, 300), st.booleans())),
)


@settings(max_examples=45, derandomize=True)
@given(
    episodes=st.lists(st.lists(st.tuples(EVENTS, st.integers(1, 120)), min_size=1, max_size=5), max_size=4),
    checked=st.sampled_from([True, True, True, False]),
    by_speed=st.booleans(),
)
def test_whatever_happens_only_an_armed_robot_with_fresh_commands_moves(
    episodes: list[list[tuple[tuple[Callable[..., None], tuple[object, ...]], int]]], checked: bool, by_speed: bool
) -> None:
    events = Events(checked, by_speed)
    for episode in episodes:
        events.recover()
        for (happen, arguments), steps in episode:
            happen(events, *arguments)
            events.pass_time(steps)
    events.recover()
