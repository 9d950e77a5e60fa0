"""A recording through the policies that made it: what each says to the recorded samples, beside what it said then.

Pure: no network, no clock. Odometry and guard are replayed whole. What base, ranger and joystick decide by comes over
serial lines, which are not recorded.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from statistics import median
from typing import Any, Final

import msgspec

from giraff_cli.replay.agreement import Agreement, differences
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import Estimate, OdometryPolicy
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import (
    Attitude,
    DriveCommand,
    GuardedCommand,
    GuardState,
    Lease,
    Odometry,
    Range,
    RobotTime,
    Sample,
    Tick,
    Wheels,
)
from giraff_schemas.requests import OdomReset, OdomSetPose
from giraff_schemas.topics import CMD_VEL, GUARD, LEASE, ODOM, SampleT

_ON_ITS_WAY_NS: Final = 500_000
"""From a sample's stamp at its maker until the guard's turn can take it, and from there to the guard's own stamp:
neither is recorded."""
_AROUND_NS: Final = 20_000_000
_SETTLES: Final = 1.0  # s after which what was missed of a young guard's life no longer shows
_SPEED: Final = 0.01
"""m/s, rad/s: what a limit may differ by. It depends on the moment of the guard's turn, known to a millisecond."""


class RecordedSamples:
    """What a recording holds, by type."""

    def __init__(self) -> None:
        self._by_type: dict[type[Sample], list[Sample]] = defaultdict(list)

    def add(self, sample: Sample) -> None:
        """The next of it."""
        self._by_type[type(sample)].append(sample)

    def of(self, type_: type[SampleT]) -> list[SampleT]:
        """Sorted by their maker's stamp."""
        samples: list[Any] = sorted(self._by_type[type_], key=lambda sample: (sample.stamp_ns, sample.seq))
        return samples


def replay_odometry(said: RecordedSamples, config: OdometryConfig, robot: RobotConfig) -> Agreement:
    """Wheels to odom, to the last bit.

    Where it went on from what was said, its covariance is left out until it is known again: how much of it is of
    wheels and track, which were wrong alike all the way, was not said. So is its path, until both grow at one sample:
    how much of a way back it had not counted yet was not said. Nor was it recorded who set its pose to what.
    """
    found = Agreement(service="odometry", key=ODOM.key)
    recorded = {(sample.boot_id, sample.board_us): sample for sample in said.of(Odometry)}
    policy: OdometryPolicy | None = None
    is_sure = False
    path_then: float | None = None  # of the sample before, while the path is not known
    last: Wheels | None = None
    for wheels in said.of(Wheels):
        then = recorded.get((wheels.boot_id, wheels.board_us))
        whole = last is not None and (wheels.instance, wheels.seq) == (last.instance, last.seq + 1)
        last = wheels
        if policy is None or not whole:
            # It was on its way already, or the recording lacks what it heard: it goes on from what it said.
            if then is not None:
                found.left_out += 1
                policy, is_sure = _going_on(OdometryPolicy(Live(config), robot), wheels, then), not any(then.covariance)
                path_then = then.path if then.path or not is_sure else None
            continue
        jumped = then is not None and then.jumps != policy.jumps
        if then is not None and jumped:
            policy.jumps = then.jumps - 1
            policy.on_reset(OdomReset(by="", id=then.jumps))
        path_now = policy.estimate.path
        now = policy.on_wheels(wheels)
        if then is None:
            continue
        if jumped and (now is None or differences(then, now, 0.0)):  # it was no reset, or some of it was not heard
            found.left_out += 1
            policy, is_sure, path_then = _going_on(policy, wheels, then), not any(then.covariance), then.path
            continue
        is_sure = is_sure or jumped or not any(then.covariance)
        if now is not None and not is_sure:
            now = msgspec.structs.replace(now, covariance=then.covariance)
        if now is not None and path_then is not None:
            if then.path > path_then and policy.estimate.path > path_now:
                policy.estimate = msgspec.structs.replace(policy.estimate, path=then.path)
                path_then = None
            else:
                path_then = then.path
            now = msgspec.structs.replace(now, path=then.path)
        found.take(then, ["not said"] if now is None else differences(then, now, 0.0))
    return found


def _going_on(policy: OdometryPolicy, wheels: Wheels, then: Odometry) -> OdometryPolicy:
    """`policy`, as it was when it said `then` to `wheels`; but for what it said nothing of."""
    policy.on_wheels(wheels)
    policy.on_set_pose(OdomSetPose(by="", id=then.jumps, x=then.x, y=then.y, yaw=then.yaw))
    policy.jumps = then.jumps
    policy.estimate = Estimate(x=then.x, y=then.y, yaw=then.yaw, covariance=then.covariance, path=then.path)
    return policy


def replay_guard(said: RecordedSamples, config: GuardConfig, robot: RobotConfig) -> list[Agreement]:
    """All that the guard hears to all that it says, turn by turn."""
    found = {key: Agreement(service="guard", key=key) for key in (CMD_VEL.key, GUARD.key, LEASE.key)}
    turns, ticks = said.of(GuardedCommand), said.of(Tick)
    if not turns or not ticks:
        return list(found.values())
    to_robot_ns = round(median(tick.robot_ns - tick.stamp_ns for tick in ticks))
    states, leases = _by_turn(turns, said.of(GuardState)), _by_turn(turns, said.of(Lease))
    inputs = _Inputs(said)
    guard: _Guard | None = None
    for index, turn in enumerate(turns):
        if guard is None or turn.instance != guard.instance:
            guard = _Guard(turns[index:], config, robot)
        now_ns = turn.stamp_ns + to_robot_ns
        new = list(inputs.until(turn))
        if turn.guard_tick is None:  # it was not linked yet: whatever was said, it did not hear
            new.clear()
        command, state, lease = guard.turn(new, now_ns)
        then_state = states.get(index)
        known = turn.guard_tick is not None and guard.known(
            now_ns, agrees=then_state is not None and not differences(then_state, state, _SPEED)
        )
        command = guard.with_faults_of(turn, command) if known else command
        for key, then, now in (
            (CMD_VEL.key, turn, command),
            (GUARD.key, then_state, state),
            (LEASE.key, leases.get(index), lease),
        ):
            if then is not None and known:
                found[key].take(then, differences(then, now, _SPEED))
            elif then is not None:
                found[key].left_out += 1
    return list(found.values())


class _Inputs:
    """What the guard had heard by each of its turns: where its own words tell it by them, and else by the stamps."""

    def __init__(self, said: RecordedSamples) -> None:
        self._waiting: dict[type[Sample], list[Any]] = {
            type_: said.of(type_)[::-1] for type_ in (Tick, Attitude, Range, Wheels, DriveCommand)
        }
        self._newest: dict[str, Range] = {}
        self._last_tick: RobotTime | None = None  # of the holder's newest command that was taken

    def until(self, turn: GuardedCommand) -> Iterator[Sample]:
        """Those that are new in this turn, in the order in which the guard takes them."""
        for type_, waiting in self._waiting.items():
            while waiting and self._taken(type_, waiting[-1], turn):
                sample = waiting.pop()
                if isinstance(sample, Range):
                    self._newest[sample.sensor] = sample
                if isinstance(sample, DriveCommand) and sample.instance == turn.operator:
                    self._last_tick = sample.tick
                yield sample

    def _taken(self, type_: type[Sample], sample: Any, turn: GuardedCommand) -> bool:
        if type_ is Tick and turn.guard_tick is not None and turn.guard_tick.epoch == sample.epoch:
            return bool(sample.robot_ns <= turn.guard_tick.robot_ns)
        is_holders = type_ is DriveCommand and sample.instance == turn.operator and _near(sample, turn)
        moment: RobotTime | None = sample.tick if is_holders else None
        used = turn.operator_tick
        # One more of the same moment is told from the one before by its stamp alone.
        if moment is not None and used is not None and not moment == used == self._last_tick:
            return moment.robot_ns <= used.robot_ns
        if type_ is Range and turn.range_tick is not None and _near(sample, turn):
            last = self._newest.get(sample.sensor)
            if turn.range_tick in (sample.tick, last.tick if last is not None else None):
                return bool(sample.tick == turn.range_tick)
        return bool(sample.stamp_ns + _ON_ITS_WAY_NS <= turn.stamp_ns)


def _near(sample: Sample, turn: GuardedCommand) -> bool:
    """Whether it is of about this turn: its tick tells it from its neighbours, and not from an old one."""
    return abs(sample.stamp_ns - turn.stamp_ns) < _AROUND_NS


class _Guard:
    """One guard's life, or what the recording has of it."""

    def __init__(self, turns: Sequence[GuardedCommand], config: GuardConfig, robot: RobotConfig) -> None:
        first = turns[0]
        self.instance = first.instance
        # The counters of its leases begin anywhere, and go on from the first.
        counter = next((turn.lease_counter for turn in turns if turn.lease_counter), 1)
        self._policy = GuardPolicy(Live(config), robot, first_lease=counter)
        self._held = first.operator
        """Whoever held the lease when the recording began; empty: nobody, or it has been granted again."""
        self._has_tick = False
        """Before its first one nobody is granted anything; the recording's may begin later than its commands."""
        age = first.seq / CMD_VEL.rate_hz
        self._settles_ns = round((min(age, config.memory_time) + _SETTLES) * 1e9)
        # One that has just begun has nothing to forget.
        self._forgets_ns = 0 if age < _SETTLES else round(max(config.fade_time, config.held_time) * 1e9)
        self._is_known = False
        self._linked_ns: int | None = None
        self._faults_before: int | None = None

    def turn(self, inputs: Iterable[Sample], now_ns: int) -> tuple[GuardedCommand, GuardState, Lease]:
        """What it says now."""
        policy = self._policy
        take: dict[type[Sample], Callable[[Any, int], object]] = {
            Tick: policy.on_tick,
            Range: policy.on_sensed,
            Bump: policy.on_sensed,
            Wheels: policy.on_wheels,
            Attitude: policy.on_attitude,
            DriveCommand: policy.on_command,
        }
        for sample in inputs:
            self._has_tick |= isinstance(sample, Tick)
            if isinstance(sample, DriveCommand) and sample.instance == self._held and self._has_tick:
                asking = msgspec.structs.replace(sample, lease_counter=0, seq=sample.seq - 1)
                policy.on_command(asking, now_ns)  # as it once did, and was granted
                self._held = ""
            take[type(sample)](sample, now_ns)
        return policy.decide(now_ns)

    def with_faults_of(self, turn: GuardedCommand, command: GuardedCommand) -> GuardedCommand:
        """What it says, with the faults that it had counted before the first turn that is compared."""
        if self._faults_before is None:
            self._faults_before = turn.faults - command.faults
        return msgspec.structs.replace(command, faults=command.faults + self._faults_before)

    def known(self, now_ns: int, *, agrees: bool) -> bool:
        """Whether what it remembers is what the recorded one remembers.

        Of one that was running before, that is so when it `agrees` on all verdicts for the first time, and at the
        latest when the recorded one, too, has forgotten what was before.
        """
        self._linked_ns = now_ns if self._linked_ns is None else self._linked_ns
        since_ns = now_ns - self._linked_ns
        self._is_known |= since_ns >= self._settles_ns and (agrees or since_ns >= self._forgets_ns)
        return self._is_known


def _by_turn(turns: Sequence[GuardedCommand], samples: Sequence[SampleT]) -> dict[int, SampleT]:
    """Each of `samples` by the index of the turn that it was said in."""
    found: dict[int, SampleT] = {}
    index = 0
    for sample in samples:
        while index + 1 < len(turns) and turns[index + 1].stamp_ns <= sample.stamp_ns:
            index += 1
        if turns[index].instance == sample.instance and turns[index].stamp_ns <= sample.stamp_ns:
            found[index] = sample
    return found
