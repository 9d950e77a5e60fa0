"""The guard: cmd_vel/<operator> + what its sensors say -> cmd_vel."""

from collections.abc import Callable
from typing import Any

from giraff_core.io import IO, Inbox
from giraff_core.lease import unranked_notice
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.timer import EarlyTimer, Timer
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy, number_place, numbers_unheard
from giraff_guard.registry import sensed_by
from giraff_schemas.messages import Sample
from giraff_schemas.topics import ATTITUDE, CMD_VEL, GUARD, LEASE, OPERATOR_CMD_VEL, TICK, WHEELS, SampleT
from giraff_schemas.trouble import NO_TROUBLE


class Guard:
    """Reads `tick`, `wheels`, `attitude`, what sensors say and `cmd_vel/*`.

    It writes `cmd_vel`, and `lease` and `guard` about it.

    It decides at once on a word of who drives and on a reading that lets less pass, and else at its rate.
    """

    link = None

    def __init__(
        self, io: IO, config: GuardConfig, robot: RobotConfig, policy: type[GuardPolicy] = GuardPolicy
    ) -> None:
        self._io = io
        live = Live(config)
        self._policy = policy(live, robot, first_lease=io.token())
        self._policy.lost_parameters = io.lost_parameters
        io.on_reconfigured = live.replace
        # All of each, and not the newest: of two makers who speak in turn, the newest may always be the same one's.
        self._ticks, self._attitudes = io.inbox(TICK, wakes=False), io.inbox(ATTITUDE, wakes=False)
        self._sensed: list[Inbox[Any]] = [io.inbox(topic) for topic in sensed_by(robot)]
        self._wheels, self._commands = io.inbox(WHEELS, wakes=False), io.inbox(OPERATOR_CMD_VEL)
        self._guarded, self._states, self._leases = io.publisher(CMD_VEL), io.publisher(GUARD), io.publisher(LEASE)
        self._timer = EarlyTimer(CMD_VEL.rate_hz)
        self._state_timer, self._lease_timer = Timer(GUARD.rate_hz), Timer(LEASE.rate_hz)
        self.timers = (self._timer,)
        self._reason, self._counter = NO_TROUBLE, 0
        self._numbers = numbers_unheard(robot)

    def turn(self, now: float) -> None:
        policy, clock = self._policy, self._io.robot_ns
        self._hand_on(self._ticks, policy.on_tick)
        self._hand_on(self._attitudes, policy.on_attitude)
        for sample in (sample for inbox in self._sensed for sample in inbox.pop_all()):
            self._note(sample)
            if policy.on_sensed(sample, clock()):
                self._timer.fire_now("range", now)
        self._hand_on(self._wheels, policy.on_wheels)
        for command in self._commands.pop_all():
            if policy.on_command(command, clock()):
                self._note(command)
                self._timer.fire_now("command", now)
        if not self._timer.due(now):
            return
        passed = policy.decide(clock(), tuple(self._numbers.values()))
        self._guarded.put(passed)
        self._tell_what_is_wrong()
        if passed.lease_counter != self._counter or self._lease_timer.due(now):
            self._counter = passed.lease_counter
            self._leases.put(policy.lease())
        if passed.reason != self._reason or self._state_timer.due(now):
            self._reason = passed.reason
            self._states.put(policy.state())

    def _hand_on(self, inbox: Inbox[SampleT], take: Callable[[SampleT, int], object]) -> None:
        for sample in inbox.pop_all():
            self._note(sample)
            take(sample, self._io.robot_ns())

    def _note(self, sample: Sample) -> None:
        """Keep the number of the newest sample, of senses that the robot file has."""
        if (place := number_place(sample)) in self._numbers:
            self._numbers[place] = sample.seq

    def _tell_what_is_wrong(self) -> None:
        policy = self._policy
        self._io.set_notice("identity", NO_TROUBLE if policy.lost_parameters else policy.fault)
        self._io.set_notice("flood", policy.flood)
        for operator in policy.unranked:
            self._io.set_notice(f"rank of {operator}", unranked_notice(operator))

    def end(self) -> None:
        """Nothing is left to say: base stops by itself."""
