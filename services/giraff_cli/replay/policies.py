"""A recording through the policies that made it: what each says to the recorded samples, beside what it said then.

Pure: no network, no clock. Odometry and guard are replayed whole. What base, ranger and joystick decide by comes over
serial lines, which are not recorded.
"""

import math
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from statistics import median
from typing import Any, Final, Generic, TypeVar

import msgspec

from giraff_cli.replay.agreement import Agreement, differences
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy, number_place, numbers_unheard
from giraff_mcap.reading import is_whole, put_params
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import Estimate, OdometryPolicy
from giraff_schemas.checks import converted
from giraff_schemas.messages import (
    Attitude,
    DriveCommand,
    GuardedCommand,
    GuardState,
    Lease,
    Odometry,
    RobotTime,
    Sample,
    Tick,
    Wheels,
)
from giraff_schemas.params import ParamAnswer
from giraff_schemas.requests import OdomReset, OdomSetPose
from giraff_schemas.services import GUARD as GUARD_SERVICE
from giraff_schemas.services import ODOMETRY
from giraff_schemas.topics import CMD_VEL, GUARD, LEASE, ODOM, SampleT

_ON_ITS_WAY_NS: Final = 500_000
"""From a sample's stamp at its maker until the guard's turn can take it, and from there to the guard's own stamp:
neither is recorded."""
_NUMBERED_NS: Final = 5_000_000_000
"""The numbers that a guard tells are of makers of about now: another one counts from 0 again."""
SETTLES: Final = 1.0  # s after which what was missed of a young guard's life no longer shows
_SPEED: Final = 0.01
"""m/s, rad/s: what a limit may differ by. It depends on the moment of the guard's turn, known to a millisecond."""


_SAYS: Final[dict[str, tuple[type[Sample], type[msgspec.Struct]]]] = {
    GUARD_SERVICE.name: (GuardedCommand, GuardConfig),
    ODOMETRY.name: (Odometry, OdometryConfig),
}
"""Samples that each replayed service says at its turns, and its configuration."""
_SENSED: Final[tuple[type[Sample], ...]] = tuple(topic.schema for topic in SENSED.values())
_TAKEN: Final[tuple[type[Sample], ...]] = (Tick, Attitude, *_SENSED, Wheels, DriveCommand)
"""Samples that the guard reads in a turn, in the order in which it reads them."""
ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)


class Settings(Generic[ConfigT]):
    """Configuration of one process, from one of its samples to the next."""

    def __init__(self, config: ConfigT, changes: Sequence[tuple[int, ParamAnswer]]) -> None:
        """`changes`: what was set, with the number of the newest sample that was said before."""
        self.live = Live(config)
        self._changes = deque(changes)

    def go_on(self, seq: int) -> None:
        """Go by what was set before the sample of this number."""
        while self._changes and self._changes[0][0] < seq:
            self.live.replace(with_params(self.live.config, self._changes.popleft()[1]))


def with_params(config: ConfigT, answer: ParamAnswer) -> ConfigT:
    """Return `config` with the values that its service has told. ValueError: they are none."""
    tables = {answer.service: msgspec.to_builtins(config)}
    try:
        put_params(tables, answer.service, answer.params)
    except TypeError as error:
        raise ValueError(f"{answer.service} has no such parameters") from error
    return converted(tables[answer.service], type(config), strict=False)


class RecordedSamples:
    """What a recording holds, by type."""

    def __init__(self) -> None:
        self._by_type: dict[type[Sample], list[Sample]] = defaultdict(list)
        self._newest: dict[tuple[type[Sample], str], int] = {}
        self._told: list[tuple[int, ParamAnswer]] = []
        """Answers, each with the number of its service's newest sample before it."""

    def add(self, sample: Sample) -> None:
        """The next of it."""
        self._by_type[type(sample)].append(sample)
        self._newest[type(sample), sample.instance] = sample.seq

    def add_params(self, answer: ParamAnswer) -> None:
        """Take what a service has told of its parameters, behind the samples that were heard before.

        ValueError: they are none that it could go by.
        """
        if (said := _SAYS.get(answer.service)) is not None:
            type_, config = said
            with_params(config(), answer)
            self._told.append((self._newest.get((type_, answer.instance), -1), answer))

    def settings(self, config: ConfigT, service: str, instance: str) -> Settings[ConfigT]:
        """Return what a process went by. `config`: what it is taken for where it has told nothing."""
        own = [told for told in self._told if (told[1].service, told[1].instance) == (service, instance)]
        for answer in [answer for _, answer in own if is_whole(answer)][:1]:
            config = with_params(config, answer)
        return Settings(config, [told for told in own if not is_whole(told[1])])

    def of(self, type_: type[SampleT]) -> list[SampleT]:
        """Sorted by their maker's stamp."""
        samples: list[Any] = sorted(self._by_type[type_], key=lambda sample: (sample.stamp_ns, sample.seq))
        return samples


def replay_odometry(said: RecordedSamples, config: OdometryConfig, robot: RobotConfig) -> Agreement:
    """Wheels to odom, to the last bit.

    Where it went on from what was said, its covariance is left out until it is known again: how much of it is of
    wheels and track, which were wrong alike all the way, was not said. Its path is left out until both paths grow in
    one step: no sample says how much of a way back is not counted yet. Nobody recorded who set its pose to what.
    """
    found = Agreement(service="odometry", key=ODOM.key)
    recorded = {(sample.boot_id, sample.board_us): sample for sample in said.of(Odometry)}
    odometry: _Odometry | None = None
    settings, instance = Settings(config, ()), ""
    last: Wheels | None = None
    for wheels in said.of(Wheels):
        then = recorded.get((wheels.boot_id, wheels.board_us))
        if then is not None:
            if then.instance != instance:
                odometry, instance = None, then.instance
                settings = said.settings(config, ODOMETRY.name, instance)
            settings.go_on(then.seq)
        whole = last is not None and (wheels.instance, wheels.seq) == (last.instance, last.seq + 1)
        last = wheels
        if odometry is None or not whole:
            # It was on its way already, or the recording lacks what it heard: it goes on from what it said.
            if then is not None:
                found.left_out += 1
                odometry = _Odometry(settings.live, robot, wheels, then)
            continue
        differs = odometry.differences(wheels, then)
        if differs is None:
            found.left_out += then is not None
        elif then is not None:
            found.add(then, differs)
    return found


class _Odometry:
    """One odometry's life, from a sample on that it has said."""

    def __init__(self, live: Live[OdometryConfig], robot: RobotConfig, wheels: Wheels, then: Odometry) -> None:
        self._policy = OdometryPolicy(live, robot)
        self._go_on(wheels, then)

    def _go_on(self, wheels: Wheels, then: Odometry) -> None:
        """Become what it was when it said `then` to `wheels`; but for what it said nothing of."""
        policy = self._policy
        policy.on_wheels(wheels)
        policy.on_set_pose(OdomSetPose(by="", id=then.jumps, x=then.x, y=then.y, yaw=then.yaw))
        policy.jumps, policy.breaks = then.jumps, then.breaks
        policy.estimate = Estimate(x=then.x, y=then.y, yaw=then.yaw, covariance=then.covariance, path=then.path)
        self._is_sure = not any(then.covariance)
        self._path_then: float | None = then.path if then.path or not self._is_sure else None  # None: path is known

    def differences(self, wheels: Wheels, then: Odometry | None) -> list[str] | None:
        """Return how what it says now differs from `then`; None where nothing is to be compared."""
        policy, path = self._policy, self._policy.estimate.path
        jumped = then is not None and then.jumps != policy.jumps
        if then is not None and jumped:
            policy.jumps = then.jumps - 1
            policy.on_reset(OdomReset(by="", id=then.jumps))
        now = policy.on_wheels(wheels)
        if then is None:
            return None
        if jumped and (now is None or differences(then, now, 0.0)):  # it was no reset, or some of it was not heard
            self._go_on(wheels, then)
            return None
        self._is_sure = self._is_sure or jumped or not any(then.covariance)
        if now is None:
            return ["not said"]
        if not self._is_sure:
            now = msgspec.structs.replace(now, covariance=then.covariance)
        if self._path_then is not None:
            both_grow = then.path > self._path_then and policy.estimate.path > path
            self._path_then = None if both_grow else then.path
            policy.estimate = msgspec.structs.replace(policy.estimate, path=then.path)
            now = msgspec.structs.replace(now, path=then.path)
        return differences(then, now, 0.0)


def replay_guard(said: RecordedSamples, config: GuardConfig, robot: RobotConfig) -> list[Agreement]:
    """All that the guard hears to all that it says, turn by turn."""
    found = {key: Agreement(service="guard", key=key) for key in (CMD_VEL.key, GUARD.key, LEASE.key)}
    turns, ticks = said.of(GuardedCommand), said.of(Tick)
    if not turns or not ticks:
        return list(found.values())
    to_robot_ns = round(median(tick.robot_ns - tick.stamp_ns for tick in ticks))
    states, leases = _by_turn(turns, said.of(GuardState)), _by_turn(turns, said.of(Lease))
    inputs = _Inputs(said, robot)
    guard: _Guard | None = None
    for index, turn in enumerate(turns):
        if guard is None or turn.instance != guard.instance:
            guard = _Guard(turns[index:], said.settings(config, GUARD_SERVICE.name, turn.instance), robot)
        guard.settings.go_on(turn.seq)
        now_ns = turn.stamp_ns + to_robot_ns
        if turn.guard_tick is not None:
            now_ns = turn.guard_tick.robot_ns + turn.decided_us * 1000
        new = list(inputs.until(turn))
        if turn.guard_tick is None:  # it was not linked yet: whatever was said, it did not hear
            new.clear()
        if inputs.lacks:
            guard.doubt(now_ns)
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
                found[key].add(then, differences(then, now, _SPEED))
            elif then is not None:
                found[key].left_out += 1
    return list(found.values())


class _Inputs:
    """Yields what the guard had heard by each of its turns.

    Its ticks and numbers tell that. The stamps decide for the rest: commands of other operators, and old samples.
    """

    def __init__(self, said: RecordedSamples, robot: RobotConfig) -> None:
        self._places = {name: index for index, name in enumerate(numbers_unheard(robot))}
        self._waiting: dict[type[Sample], list[Any]] = {type_: said.of(type_)[::-1] for type_ in _TAKEN}
        self._numbers: dict[str, tuple[str, int]] = {}
        """Maker and number of the newest sample that was taken, by `number_place`."""
        self._tick: RobotTime | None = None  # the newest that was taken
        self.lacks = False
        """The guard had heard something by the newest turn that the recording lacks."""

    def until(self, turn: GuardedCommand) -> Iterator[Sample]:
        """Those that are new in this turn, in the order in which the guard takes them."""
        self.lacks = False
        for waiting in self._waiting.values():
            while waiting and self._taken(waiting[-1], turn):
                sample = waiting.pop()
                if isinstance(sample, Tick):
                    self._tick = sample.time
                if self._is_numbered(sample, turn):
                    maker, number = self._numbers.get(number_place(sample), ("", 0))
                    self.lacks |= maker == sample.instance and sample.seq != number + 1
                    self._numbers[number_place(sample)] = sample.instance, sample.seq
                yield sample
        self.lacks |= self._tick is not None and turn.guard_tick not in {None, self._tick}
        self.lacks |= any(
            self._numbers[name][1] < turn.heard[place]
            for name, place in self._places.items()
            if name in self._numbers and name != "command" and place < len(turn.heard)
        )

    def _is_numbered(self, sample: Sample, turn: GuardedCommand) -> bool:
        """Tell whether the guard numbers this sample in `heard`."""
        is_of_holder = not isinstance(sample, DriveCommand) or sample.instance == turn.operator
        return is_of_holder and self._places.get(number_place(sample), math.inf) < len(turn.heard)

    def _taken(self, sample: Sample, turn: GuardedCommand) -> bool:
        if isinstance(sample, Tick) and turn.guard_tick is not None and turn.guard_tick.epoch == sample.epoch:
            return sample.robot_ns <= turn.guard_tick.robot_ns
        if self._is_numbered(sample, turn) and abs(sample.stamp_ns - turn.stamp_ns) < _NUMBERED_NS:
            return sample.seq <= turn.heard[self._places[number_place(sample)]]
        return sample.stamp_ns + _ON_ITS_WAY_NS <= turn.stamp_ns


class _Guard:
    """One guard's life, or what the recording has of it."""

    def __init__(self, turns: Sequence[GuardedCommand], settings: Settings[GuardConfig], robot: RobotConfig) -> None:
        self.settings = settings
        config, first = settings.live.config, turns[0]
        self.instance = first.instance
        # The counters of its leases begin anywhere, and go on from the first.
        counter = next((turn.lease_counter for turn in turns if turn.lease_counter), 1)
        self._policy = GuardPolicy(settings.live, robot, first_lease=counter)
        self._counter = counter
        """Counter of the first lease. The recording may lack its grant, or the tick before. 0: it is granted here."""
        self._has_tick = False
        """Before its first one nobody is granted anything; the recording's may begin later than its commands."""
        age = first.seq / CMD_VEL.rate_hz
        self._settles_ns = round((min(age, config.memory_time) + SETTLES) * 1e9)
        # One that has just begun has nothing to forget.
        self._forgets_ns = 0 if age < SETTLES else round(max(config.trust_end_time, config.silent_time) * 1e9)
        self._forgets_travel = 0.0 if age < SETTLES else config.trust_end_travel
        self._is_known = False
        self._linked_ns: int | None = None
        self._linked_travel = 0.0
        self._faults_before: int | None = None

    def turn(self, inputs: Iterable[Sample], now_ns: int) -> tuple[GuardedCommand, GuardState, Lease]:
        """What it says now."""
        policy = self._policy
        take: dict[type[Sample], Callable[[Any, int], object]] = {
            Tick: policy.on_tick,
            **dict.fromkeys(_SENSED, policy.on_sensed),
            Wheels: policy.on_wheels,
            Attitude: policy.on_attitude,
            DriveCommand: policy.on_command,
        }
        for sample in inputs:
            self._has_tick |= isinstance(sample, Tick)
            if isinstance(sample, DriveCommand) and 0 < sample.lease_counter == self._counter and self._has_tick:
                asking = msgspec.structs.replace(sample, lease_counter=0, seq=sample.seq - 1)
                policy.on_command(asking, now_ns)  # as it once did, and was granted
            take[type(sample)](sample, now_ns)
        command, lease = policy.decide(now_ns), policy.lease()
        if lease.holder:
            self._counter = 0
        return command, policy.state(), lease

    def with_faults_of(self, turn: GuardedCommand, command: GuardedCommand) -> GuardedCommand:
        """What it says, with the faults that it had counted before the first turn that is compared."""
        if self._faults_before is None:
            self._faults_before = turn.faults - command.faults
        return msgspec.structs.replace(command, faults=command.faults + self._faults_before)

    def doubt(self, now_ns: int) -> None:
        """Begin anew to learn what it remembers: it had heard something that was not recorded."""
        self._is_known, self._linked_ns, self._faults_before = False, now_ns, None
        self._linked_travel = self._policy.travel

    def known(self, now_ns: int, *, agrees: bool) -> bool:
        """Whether what it remembers is what the recorded one remembers.

        Of one that was running before, that is so when it `agrees` on all verdicts for the first time, and at the
        latest when the recorded one, too, has forgotten what was before. A sensor is trusted for some way,
        which only way ends.
        """
        self._linked_ns = now_ns if self._linked_ns is None else self._linked_ns
        since_ns = now_ns - self._linked_ns
        has_come = self._policy.travel - self._linked_travel >= self._forgets_travel
        self._is_known |= has_come and since_ns >= self._settles_ns and (agrees or since_ns >= self._forgets_ns)
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
