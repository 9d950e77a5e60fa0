"""The guard's whole policy. No I/O and no clock: time is an argument."""

from typing import Final

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED, Sensed
from giraff_guard.config import GuardConfig
from giraff_guard.flood import FloodWatch
from giraff_guard.identity import Identity
from giraff_guard.lease_holder import LeaseHolder
from giraff_guard.obstacles import Obstacles
from giraff_schemas.messages import (
    Attitude,
    DriveCommand,
    GuardedCommand,
    GuardState,
    Lease,
    RobotTime,
    Sample,
    SensorState,
    Tick,
    Wheels,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble

HEARD: Final = ("wheels", "attitude", "command")
"""Order of the numbers in `GuardedCommand.heard`. Those of the sensors follow, by type and name."""
_PLACES: Final[dict[type[Sample], str]] = {Wheels: "wheels", Attitude: "attitude", DriveCommand: "command"}


class GuardPolicy:
    """The third of the four safety layers: identity, lease, freshness, obstacles and blind directions.

    It must run on base's host: `robot_ns` is always this process's own reading of the clock that base makes its ticks
    of. What is older than its budget is refused here and by base; slowing down what is late is base's alone.
    """

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig, first_lease: int) -> None:
        self._identity = Identity(live.config, robot)
        self._lease_holder = LeaseHolder(live, first_lease)
        self._obstacles = Obstacles(live, robot)
        self._floods = FloodWatch()
        self._types = robot.sensor_types
        self._replacements = 0  # how often `fault` has come to be
        self.lost_parameters = NO_TROUBLE
        """A saved limit that may be lost. Nothing passes then."""
        self.fault = NO_TROUBLE
        """Two processes where one may be, as `decide` found it, or a lost limit."""
        self.flood = NO_TROUBLE
        """Whose commands flood the guard, as `decide` found it."""
        self._decided_ns = 0
        self._reason = NO_TROUBLE

    @property
    def unranked(self) -> tuple[str, ...]:
        """Operators that have asked to drive, and whose names no table ranks."""
        return self._lease_holder.unranked

    @property
    def travel(self) -> float:
        """m the robot has made since the epoch began, backwards counted too."""
        return self._obstacles.travel

    def on_tick(self, tick: Tick, robot_ns: int) -> None:
        """Take base's clock."""
        if self._identity.on_tick(tick, robot_ns):
            self._obstacles.forget()

    def on_sensed(self, sample: Sensed, robot_ns: int) -> bool:
        """Take what a sensor says. True: it blocks or slows a direction, which cannot wait for the next decision."""
        if not self._identity.admits_sensed(sample, robot_ns):
            return False
        return self._obstacles.on_sensed(sample, self._identity.now(robot_ns))

    def on_wheels(self, wheels: Wheels, robot_ns: int) -> None:
        """Take what the wheels do."""
        if self._identity.admits_report(wheels, robot_ns):
            self._obstacles.on_wheels(wheels, self._identity.now(robot_ns))

    def on_attitude(self, attitude: Attitude, robot_ns: int) -> None:
        """Take how a robot that balances leans."""
        if self._identity.admits_report(attitude, robot_ns):
            self._obstacles.on_attitude(attitude)

    def on_command(self, command: DriveCommand, robot_ns: int) -> bool:
        """Take an operator's command. True: it is a word of who drives, which cannot wait for the next decision."""
        self._floods.count(command, robot_ns)
        return self._lease_holder.on_command(command, self._identity.now(robot_ns))

    def decide(self, robot_ns: int, heard: tuple[int, ...] = ()) -> GuardedCommand:
        """Return what to let through now. `heard`: the numbers of what was heard, by `HEARD`.

        `state` and `lease` describe this decision. They are called only when somebody must be told.
        """
        now = self._identity.now(robot_ns)
        lease = self._lease_holder
        lease.review(now)
        before, self.fault = self.fault, self.lost_parameters or self._identity.fault(robot_ns)
        self._replacements += bool(self.fault) and not before
        self.flood = self._floods.judge(robot_ns)
        self._obstacles.judge(now)
        asked, refusal = self._asked(now)
        wish = (asked.linear_x, asked.angular_z) if asked is not None else (0.0, 0.0)
        limited = self._obstacles.limit(*wish, now)
        newest, tick = lease.command, self._identity.tick
        self._decided_ns, self._reason = robot_ns, refusal or limited.reason
        return GuardedCommand(
            linear_x=limited.linear_x,
            angular_z=limited.angular_z,
            guard_tick=tick,
            operator=lease.holder,
            lease_counter=lease.counter,
            operator_tick=newest.tick if newest is not None else None,
            range_tick=limited.range_tick,
            source="fault" if self.fault or newest is None else newest.source,
            faults=lease.faults + self._replacements,
            hand_neutral=asked is not None and asked.neutral,
            reason=self._reason,
            free_side="none" if self.fault else self._obstacles.free_side(now),
            heard=heard,
            decided_us=-1 if tick is None else (robot_ns - tick.robot_ns) // 1000,
        )

    def state(self) -> GuardState:
        """Return the verdict for each direction, as of the newest decision. Call it before the next sample is taken."""
        verdicts, now = self._obstacles.verdicts, self._identity.now(self._decided_ns)
        sensors = self._obstacles.troubles(now) | self._identity.sensor_faults(self._decided_ns)
        return GuardState(
            forward=verdicts.forward,
            backward=verdicts.backward,
            turn_left=verdicts.turn_left,
            turn_right=verdicts.turn_right,
            operator=self._lease_holder.holder,
            reason=self._reason,
            sensors={name: SensorState(type=self._types[name], trouble=why) for name, why in sensors.items()},
        )

    def lease(self) -> Lease:
        """Return whom the guard obeys, as of the newest decision."""
        lease = self._lease_holder
        who = lease.reason(self._identity.now(self._decided_ns))
        return Lease(
            holder=lease.holder,
            operator=lease.operator,
            counter=lease.counter,
            reason=who,
            unranked=self.unranked,
        )

    def _asked(self, now: RobotTime) -> tuple[DriveCommand | None, Trouble]:
        """The operator's command if it counts, else why none does."""
        refusal = self.fault or self._identity.base_fault(now.robot_ns)
        return (None, refusal) if refusal else self._lease_holder.asked(now)


def numbers_unheard(robot: RobotConfig) -> dict[str, int]:
    """Return the numbers of `GuardedCommand.heard` of a guard that has heard nothing."""
    sensors = (name for sense in SENSED for name in sorted(robot.of(sense)))
    return dict.fromkeys((*HEARD, *(f"sensor {name}" for name in sensors)), -1)


def number_place(sample: Sample) -> str:
    """Return the name that its number has among them. Commands count where they are the lease holder's."""
    sensor = getattr(sample, "sensor", "")
    return f"sensor {sensor}" if sensor else _PLACES.get(type(sample), "")
