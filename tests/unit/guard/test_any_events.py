"""Whatever is said, by whomever, in whatever order: what comes out keeps to the rules."""

from collections.abc import Callable
from typing import Final

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_core.lease import ASK, LeaseClient
from giraff_schemas.messages import DriveCommand, GuardedCommand, GuardState, RobotTime, Source
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.checks import check_passed
from tests.unit.guard.rig import CONFIG, EPOCH, FAR, FIRST_LEASE, Rig


def check_verdicts(state: GuardState) -> None:
    """That each verdict is whole: it says no without a number, a reason and a way out for nobody."""
    for verdict in (state.forward, state.backward, state.turn_left, state.turn_right):
        assert verdict.allowed >= 0.0
        assert (verdict.clearance == "blocked") == (verdict.allowed == 0.0)
        assert (verdict.clearance == "free") == (str(verdict.reason) == "")
        if verdict.clearance == "blocked":
            assert verdict.sensor
            assert verdict.reason.remedy


AGES_MS = st.integers(-100, 600)


@given(
    linear=st.one_of(st.just(0.0), st.floats(-2.0, 2.0).filter(lambda v: abs(v) > 1e-6)),
    angular=st.floats(-6.0, 6.0),
    distances=st.tuples(*[st.one_of(st.none(), st.floats(0.02, 4.0))] * 3),
    ages_ms=st.tuples(*[AGES_MS] * 3),
    command_age_ms=AGES_MS,
    velocity=st.floats(-0.7, 0.7),
    faulty=st.sampled_from(["", "", "", "front_left", "rear"]),
    waits_ms=st.lists(st.integers(0, 200), max_size=5),
)
def test_whatever_comes_in_no_more_comes_out_than_was_asked(
    linear: float,
    angular: float,
    distances: tuple[float | None, ...],
    ages_ms: tuple[int, ...],
    command_age_ms: int,
    velocity: float,
    faulty: str,
    waits_ms: list[int],
) -> None:
    rig = Rig()
    for wait in [0, *waits_ms]:
        rig.wait(wait / 1000)
        for sensor, distance, age_ms in zip(rig.robot.sensors, distances, ages_ms, strict=True):
            rig.hear(distance, sensor, age=age_ms / 1000, fault="broken" if sensor == faulty else "")
        rig.move(velocity)
        rig.ask(linear, angular, age=command_age_ms / 1000)
        command, state = rig.decide()
        check_passed(command, state, linear, angular)
        assert state.reason == command.reason
        check_verdicts(state)
        if not 0 <= command_age_ms <= 400:
            assert command.neutral


NAMES: Final = {"operator-1": "joystick", "operator-2": "joystick", "operator-3": "carer"}
COUNTERS: Final = [ASK, FIRST_LEASE - 1, *range(FIRST_LEASE, FIRST_LEASE + 4)]


class Witness(Rig):
    """Keeps its own book of what each operator has said, to judge what the guard makes of it."""

    def __init__(self) -> None:
        super().__init__(config=msgspec.structs.replace(CONFIG, priorities={"carer": 1}))
        self.said: list[DriveCommand] = []
        self.seekers = {operator: LeaseClient(operator) for operator in NAMES}

    def drive(self, operator: str, linear: float, source: Source, times: int) -> None:
        """An operator's service does as it should: base ticks, it asks or commands, and hears what comes of it."""
        for _ in range(times):
            self.wait(0.02)
            counter = self.seekers[operator].counter(wishes=linear != 0.0)
            self.said.append(
                self.ask(linear, age=0.01, operator=operator, source=source, counter=counter, name=NAMES[operator])
            )
            self.check()

    def speak(self, operator: str, counter: int, linear: float, source: Source, age: float, seq: int) -> None:
        self.said.append(
            self.ask(
                linear, 0.2, age=age, operator=operator, source=source, counter=counter, seq=seq, name=NAMES[operator]
            )
        )

    def replay(self, back: int) -> None:
        """Something that was said comes once more."""
        if self.said:
            self.guard.on_command(self.said[-1 - back % len(self.said)], self.robot_ns)

    def check(self) -> None:
        command, _ = self.decide()
        assert self.lease is not None
        for seeker in self.seekers.values():
            seeker.on_lease(self.lease)
        assert (command.operator, command.lease_counter) == (self.lease.holder, self.lease.counter)
        assert bool(self.lease.holder) == (self.lease.counter != 0)
        if command.guard_tick is not None:
            assert command.guard_tick.robot_ns <= self.robot_ns
        if command.neutral and not command.hand_neutral:
            assert command.reason
            return
        # Something passes, or arms: there is a command that accounts for it.
        assert command.source == "hand"
        assert any(
            each.instance == self.lease.holder
            and each.lease_counter == self.lease.counter
            and each.source == "hand"
            and each.tick == command.operator_tick
            and self._fresh(each.tick, command)
            and abs(command.linear_x) <= abs(each.linear_x)
            for each in self.said
        )
        assert self.guard.fault == NO_TROUBLE

    def _fresh(self, tick: RobotTime | None, command: GuardedCommand) -> bool:
        assert command.guard_tick is not None
        return (
            tick is not None
            and tick.epoch == command.guard_tick.epoch
            and 0 <= self.robot_ns - tick.robot_ns <= CONFIG.operator_budget * 1e9
        )


OPERATORS = st.sampled_from(list(NAMES))
Word = Callable[[Witness], None]
DRIVES: st.SearchStrategy[Word] = st.builds(
    lambda *how: lambda rig: rig.drive(*how),
    OPERATORS,
    st.sampled_from([0.0, 0.0, 0.3, -0.3]),
    st.sampled_from(["hand", "hand", "hand", "fault"]),
    st.integers(1, 4),
)
WORDS: st.SearchStrategy[Word] = st.one_of(
    DRIVES,
    DRIVES,
    st.builds(
        lambda *said: lambda rig: rig.speak(*said),
        OPERATORS,
        st.sampled_from(COUNTERS),
        st.sampled_from([0.0, 0.3, -0.3]),
        st.sampled_from(["hand", "hand", "hand", "fault"]),
        st.sampled_from([0.0, 0.0, 0.3, 0.41, 8.0, -0.1]),
        st.integers(0, 500),
    ),
    st.builds(lambda back: lambda rig: rig.replay(back), st.integers(0, 20)),
    st.builds(lambda seconds: lambda rig: rig.wait(seconds), st.sampled_from([0.0, 0.02, 0.1, 0.3, 0.6, 1.1])),
    st.builds(lambda seconds: lambda rig: rig.pause(seconds), st.sampled_from([0.1, 0.3, 0.6, 8.0])),
    st.builds(lambda epoch: lambda rig: rig.tick(epoch), st.sampled_from([EPOCH, EPOCH, EPOCH + 1])),
    st.builds(
        lambda age, ranger: lambda rig: rig.hear(FAR, age=age, ranger=ranger),
        st.sampled_from([0.0, 0.1, 0.45, 2.0, -0.1]),
        st.sampled_from(["ranger-1", "ranger-1", "ranger-2"]),
    ),
)


@settings(max_examples=50, derandomize=True)
@given(words=st.lists(WORDS, min_size=10, max_size=60))
def test_only_the_holders_fresh_hand_ever_moves_or_arms(words: list[Word]) -> None:
    rig = Witness()
    rig.look()
    for word in words:
        word(rig)
        rig.check()
