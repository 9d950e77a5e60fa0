"""Whatever happens in whatever order: the robot moves only when armed, on fresh commands, and says why it does not."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.wire import DriveState
from tests.unit.base.rig import EPOCH, ROBOT, Rig, Sent

NS = 1_000_000_000


class Judge:
    """Base's rules in other words: what must be true of a frame that moves the robot."""

    def __init__(self) -> None:
        self.heard: list[tuple[int, GuardedCommand]] = []
        self.reset_ns = 0
        """The last moment after which the robot must be armed anew."""
        self.operator = ""

    def hear(self, command: GuardedCommand, now_ns: int, bound: str) -> None:
        """A new command, and whom base obeyed when it came."""
        if bound not in ("", command.instance):
            self.reset_ns = now_ns + 1  # whatever it says, it arms nothing with what came before
        elif self.age_ns(command.guard_tick, now_ns) <= 200_000_000:
            if command.operator != self.operator:
                self.reset_ns = now_ns
            if command.source == "fault":
                self.reset_ns = now_ns + 1
            self.operator = command.operator
        self.heard.append((now_ns, command))

    def age_ns(self, tick: RobotTime | None, now_ns: int) -> int:
        if tick is None or tick.epoch != EPOCH or tick.robot_ns > now_ns:
            return 10**18
        return now_ns - tick.robot_ns

    def may_drive(self, now_ns: int) -> bool:
        """Whether some command that was heard is fresh in all its parts and asks for motion."""
        return any(self._fresh(command, now_ns) for heard_ns, command in self.heard if now_ns - heard_ns <= NS)

    def _fresh(self, command: GuardedCommand, now_ns: int) -> bool:
        return (
            command.source == "hand"
            and not command.neutral
            and self.age_ns(command.operator_tick, now_ns) < 400_000_000
            and self.age_ns(command.guard_tick, now_ns) < 200_000_000
            and (command.range_tick is None or self.age_ns(command.range_tick, now_ns) <= 400_000_000)
        )

    def was_armed(self) -> bool:
        """Whether a hand was neutral for 0.2 s of its own time since the last reset."""
        neutral = [
            command.operator_tick.robot_ns
            for heard_ns, command in self.heard
            if heard_ns >= self.reset_ns
            and command.hand_neutral
            and command.operator_tick is not None
            and self.age_ns(command.operator_tick, heard_ns) <= 400_000_000
            and self.age_ns(command.guard_tick, heard_ns) <= 200_000_000
        ]
        return any(later - earlier >= 200_000_000 for n, earlier in enumerate(neutral) for later in neutral[n + 1 :])


class Events:
    """Anything at all happens to base, and each frame is judged."""

    def __init__(self) -> None:
        self.rig = Rig()
        self.judge = Judge()
        self.session = 99

    def pass_time(self, steps: int) -> None:
        for n in range(steps):
            speaks, self.rig.guard_speaks = self.rig.guard_speaks, False
            before = len(self.rig.sent)
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
        """All is well again: the hand is level, then it drives."""
        rig = self.rig
        rig.source, rig.epoch, rig.guard_speaks, rig.connected = "hand", EPOCH, True, True
        rig.operator_age, rig.guard_age, rig.range_age, rig.operator_tick = 0.03, 0.005, 0.1, None
        rig.tilt(0.0)
        self.pass_time(100)
        assert rig.base.state().armed, rig.base.state().reason
        rig.tilt(0.6, 0.5)
        self.pass_time(30)
        assert rig.sent[-1].moves, rig.sent[-1].state.reason

    def change(self, attribute: str, value: object) -> None:
        setattr(self.rig, attribute, value)

    def freeze(self) -> None:
        self.rig.operator_tick = self.rig.ago(0.03)

    def open_again(self) -> None:
        self.session += 1
        self.rig.base.on_link_opened(self.session)
        self.judge.reset_ns = self.rig.robot_ns + 1

    def lose(self) -> None:
        self.rig.base.on_link_lost("unplugged")
        self.judge.reset_ns = self.rig.robot_ns + 1

    def reset_board(self) -> None:
        self.rig.board.reset()
        if self.rig.connected:
            self.judge.reset_ns = self.rig.robot_ns + 1

    def replay(self, back: int, forged: bool) -> None:
        """Something that was heard comes again: it must count for nothing, so the judge does not hear it."""
        _, command = self.judge.heard[-min(back, len(self.judge.heard))]
        if command.instance != self.rig.base.state().guard:
            self.judge.reset_ns = self.rig.robot_ns + 1
        self.rig.say(msgspec.structs.replace(command, linear_x=0.6, hand_neutral=False) if forged else command)

    def check(self, sent: Sent) -> None:
        asked = self.rig.base._command
        if sent.moves:
            assert sent.state.armed
            assert sent.state.reason == "" or "slowed" in sent.state.reason
            assert self.judge.may_drive(sent.robot_ns)
            assert self.judge.was_armed()
            assert sent.report.drive_state == DriveState.ACTIVE
            assert sent.report.session == self.session
        elif asked is None or not asked.neutral:
            assert sent.state.reason
        assert (sent.frame.board_ms, sent.frame.boot_id) == (sent.report.board_ms, sent.report.boot_id)
        assert max(map(abs, sent.levels)) <= ROBOT.max_level


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
    changes("guard", "guard-1", "guard-2"),
    changes("connected", False, True),
    st.sampled_from(
        [
            (Events.freeze, ()),
            (Events.open_again, ()),
            (Events.lose, ()),
            (Events.reset_board, ()),
            (Events.change, ("operator_tick", None)),
        ]
    ),
    st.tuples(st.just(Events.replay), st.tuples(st.integers(1, 300), st.booleans())),
)


@settings(max_examples=100, deadline=None)
@given(episodes=st.lists(st.lists(st.tuples(EVENTS, st.integers(1, 120)), min_size=1, max_size=5), max_size=4))
def test_whatever_happens_only_an_armed_robot_with_fresh_commands_moves(
    episodes: list[list[tuple[tuple[Callable[..., None], tuple[object, ...]], int]]],
) -> None:
    events = Events()
    for episode in episodes:
        events.recover()
        for (happen, arguments), steps in episode:
            happen(events, *arguments)
            events.pass_time(steps)
    events.recover()
