"""What can break in a robot of processes, and what a row of the fault table is made of."""

import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from giraff_node.network.query_client import QueryClient
from giraff_schemas.requests import EStopEngage
from giraff_schemas.topics import ESTOP_ENGAGE
from giraff_schemas.trouble import Trouble
from giraff_sim.control.messages import BoardName, Wheel
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault
from tests.dst.courses import HAND
from tests.support.process_robot import FULL_TILT, ProcessRobot

ROBOT_SIDE: Final = 0.35
OPERATORS: Final = 0.45
"""s to PWM 0 after a fault of the operator's side, its link, or the ranger's."""
TWO_AT_ONCE: Final = 0.55

FORWARD: Final = (FULL_TILT, 0.0)
BACKWARD: Final = (-FULL_TILT, 0.0)
LEFT: Final = (0.0, FULL_TILT)
RIGHT: Final = (0.0, -FULL_TILT)
LEVEL: Final = (0.0, 0.0)

MOVING: Final = ", while a motion moves it"
"""In the names of those rows."""


@dataclass(frozen=True)
class Fault:
    """Something that breaks, and how it is mended."""

    name: str
    begin: Callable[[ProcessRobot], int | None]
    """Answers with the simulated us of the fault where it knows it better than the caller."""
    end: Callable[[ProcessRobot], object] = lambda _robot: None
    latches: bool = False
    """It engages the emergency stop, or may, as a wheel does that is held a third time; reset once all is mended."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One row: the robot drives, breaks, is mended, and drives again, with none of its other services restarted."""

    faults: tuple[Fault, ...]
    does: Literal["stops", "creeps", "slows", "dips", "drives on"] = "stops"
    """`creeps`: drives at 0.10 m/s at most. `slows`: at 0.16 m/s at most. `dips`: may stop meanwhile, and drives again
    by itself within 2 s of the end."""
    bound: float = 0.0
    """s to PWM 0 of what stops, to creeping, or to what is slow."""
    lasts: float = 1.5
    """s from its begin to its end."""
    rearms: bool = True
    """Of what stops: also after the end nothing is driven before the hand was level."""
    tilt: tuple[float, float] = FORWARD
    by: Literal["hand", "motion"] = "hand"
    """What drives it: a tilted joystick, or a motion that `giraff move` has asked for."""
    parts: Mapping[str, str] = field(default_factory=dict)
    """Variables of a robot that has what breaks, where the stock one does not."""
    loads: bool = False
    """The fault is that this machine stalls: such runs are not repeated."""

    @property
    def fault(self) -> str:
        """What breaks, however long it lasts and wherever the robot goes."""
        return " + ".join(fault.name for fault in self.faults) + (MOVING if self.by == "motion" else "")

    @property
    def name(self) -> str:
        ways = {FORWARD: "", BACKWARD: ", backward", LEFT: ", turning"}
        return f"{self.fault}, {self.lasts:g} s{ways[self.tilt]}"


def _does(action: Callable[[ProcessRobot], object]) -> Callable[[ProcessRobot], None]:
    """An action whose answer says nothing of when the fault was."""

    def act(robot: ProcessRobot) -> None:
        action(robot)

    return act


def killed(service: str) -> Fault:
    return Fault(f"{service} killed", _does(lambda robot: robot.kill(service)), lambda robot: robot.start(service))


def ended(service: str) -> Fault:
    return Fault(f"{service} ended", _does(lambda robot: robot.stop(service)), lambda robot: robot.start(service))


def suspended(service: str) -> Fault:
    return Fault(
        f"{service} suspended",
        _does(lambda robot: robot.signal(service, signal.SIGSTOP)),
        lambda robot: robot.signal(service, signal.SIGCONT),
    )


def _kill_requester(robot: ProcessRobot) -> None:
    robot.kill("requester")


REQUESTER_KILLED: Final = Fault("requester killed", _kill_requester)
"""Nobody starts another one."""


def unplugged(board: BoardName) -> Fault:
    return Fault(
        f"{board} board unplugged",
        lambda robot: robot.simulator.unplug(board),
        lambda robot: robot.simulator.plug(board),
    )


def reset(board: BoardName, cause: Literal["power_on", "external", "brown_out", "watchdog"] = "external") -> Fault:
    return Fault(f"{board} board reset ({cause})", lambda robot: robot.simulator.reset(board, cause))


def sonar(number: int, fault: SonarFault) -> Fault:
    return Fault(
        f"sonar {number} {fault}",
        lambda robot: robot.simulator.fail_sonar(number, fault),
        lambda robot: robot.simulator.fail_sonar(number, SonarFault.NONE),
    )


def bumper_cut(name: str, number: int) -> Fault:
    return Fault(
        f"{name} bumper's wire cut",
        lambda robot: robot.simulator.cut_bumper(number, cut=True),
        lambda robot: robot.simulator.cut_bumper(number, cut=False),
    )


def deaf(
    *numbers: int,
    after: float = 0.0,
    then: Sequence[tuple[tuple[float, float], float]] = (),
    on: tuple[float, float] = FORWARD,
    told: str = "",
    fault: SonarFault = SonarFault.DEAF,
) -> Fault:
    """Nothing answers these sonars, from `after` s on.

    `then` the hand does this, each tilt for its seconds, and tilts `on`: it is this that the row's times begin with.
    `told`: in the row's name, of what is done.
    """

    def begin(robot: ProcessRobot) -> int:
        robot.run(after)
        begun_us = max(robot.simulator.fail_sonar(number, fault) for number in numbers)
        for tilt, seconds in then:
            robot.hold(*tilt)
            robot.run(seconds)
        return robot.hold(*on) if then else begun_us

    def end(robot: ProcessRobot) -> None:
        for number in numbers:
            robot.simulator.fail_sonar(number, SonarFault.NONE)

    return Fault(f"sonar {' and '.join(map(str, numbers))} deaf{told and ', '}{told}", begin, end)


def sonar_flickers(number: int, seconds: float) -> Fault:
    """Dead and alive by turns, so that of its pings, 0.18 s apart, there are never two good ones in a row."""

    def begin(robot: ProcessRobot) -> int:
        begun_us = robot.simulator.now()
        for _ in range(round(seconds / 0.35)):
            robot.simulator.fail_sonar(number, SonarFault.DEAD)
            robot.run(0.23)
            robot.simulator.fail_sonar(number, SonarFault.NONE)
            robot.run(0.12)
        return begun_us

    return Fault(
        f"sonar {number} flickers",
        begin,
        lambda robot: robot.simulator.fail_sonar(number, SonarFault.NONE),
    )


def tilt_sensor(fault: Bno055Fault) -> Fault:
    return Fault(
        f"tilt sensor {fault}",
        lambda robot: robot.simulator.fail_bno055(fault),
        lambda robot: robot.simulator.fail_bno055(Bno055Fault.NONE),
    )


def encoder_cut(wheel: Wheel) -> Fault:
    return Fault(
        f"{wheel} encoder cut",
        lambda robot: robot.simulator.cut_encoder(wheel, cut=True),
        lambda robot: robot.simulator.cut_encoder(wheel, cut=False),
        latches=True,
    )


def _flicker(robot: ProcessRobot, *, flickers: bool) -> None:
    robot.simulator.flicker_encoder("left", flickers=flickers)
    robot.simulator.flicker_encoder("right", flickers=flickers)


ENCODERS_FLICKER: Final = Fault(
    "both encoders on the edge of a count at rest",
    lambda robot: _flicker(robot, flickers=True),
    lambda robot: _flicker(robot, flickers=False),
)


def encoder_slips(wheel: Wheel) -> Fault:
    """Lose half of the counts. Base trusts the wheel again only once it is started anew."""

    def end(robot: ProcessRobot) -> None:
        robot.simulator.slip_encoder(wheel, 0.0)
        robot.kill("base")
        robot.start("base")

    return Fault(
        f"{wheel} encoder loses half of its counts", lambda robot: robot.simulator.slip_encoder(wheel, 0.5), end
    )


def wheel_blocked(wheel: Wheel) -> Fault:
    return Fault(
        f"{wheel} wheel blocked",
        lambda robot: robot.simulator.block_wheel(wheel, blocked=True),
        lambda robot: robot.simulator.block_wheel(wheel, blocked=False),
        latches=True,
    )


def wheel_held_back(wheel: Wheel) -> Fault:
    return Fault(
        f"{wheel} wheel held back",
        lambda robot: robot.simulator.brake_wheel(wheel, HAND),
        lambda robot: robot.simulator.brake_wheel(wheel, 0.0),
        latches=True,
    )


def battery(volts: float) -> Fault:
    return Fault(
        f"battery at {volts:g} V",
        lambda robot: robot.simulator.battery(volts),
        lambda robot: robot.simulator.battery(24.5),
    )


def joystick_is(hand: Literal["dropped", "laid_down", "shaken"]) -> Fault:
    """Afterwards a hand holds it tilted."""
    return Fault(
        f"joystick {hand.replace('_', ' ')}",
        lambda robot: robot.simulator.hand(hand),
        lambda robot: robot.hold(FULL_TILT, 0.0),
    )


def _engage(robot: ProcessRobot) -> int:
    """Ask base itself until it has stopped, whether or not its disk takes it."""
    at_us = robot.simulator.now()
    name = robot.environment["GIRAFF_ROBOT_NAME"]
    request = EStopEngage(by="test", reason=Trouble("a scenario"))
    asking = QueryClient(robot.observer.session, name, ESTOP_ENGAGE, request, lambda answer: answer.engaged)
    robot.wait("the answer of base", lambda: asking.poll(time.monotonic()) is not None, 5.0)
    return at_us


ESTOP_ENGAGED: Final = Fault("e-stop engaged", _engage, latches=True)


def disk_full(service: str) -> Fault:
    """Nothing that the process writes finds room, its log included."""

    def limit(robot: ProcessRobot, room: int) -> None:
        _, most = resource.prlimit(robot.pid(service), resource.RLIMIT_FSIZE)
        resource.prlimit(robot.pid(service), resource.RLIMIT_FSIZE, (room, most))

    return Fault(
        f"disk full for {service}",
        _does(lambda robot: limit(robot, 0)),
        lambda robot: limit(robot, resource.RLIM_INFINITY),
    )


def second(service: str, **changes: str) -> Fault:
    """Its begin is when it has joined the network, shortly before it is heard."""

    def begin(robot: ProcessRobot) -> int:
        robot.start_second(service, **changes)
        return robot.simulator.now()

    return Fault(f"second {service}", begin, lambda robot: robot.stop(f"second {service}"))


def second_hand() -> Fault:
    """A second joystick of the same name, with a hand that tilts it."""

    def begin(robot: ProcessRobot) -> int:
        with robot.start_second_hand() as other:
            other.tilt(-FULL_TILT, 0.0)
        return robot.simulator.now()

    def end(robot: ProcessRobot) -> None:
        robot.stop("second joystick")
        robot.stop("second simulator")

    return Fault("second joystick, tilted the other way", begin, end)


def hogged(processes: int) -> Fault:
    running: list[subprocess.Popen[bytes]] = []

    def begin(_robot: ProcessRobot) -> None:
        running.extend(subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes))

    def end(_robot: ProcessRobot) -> None:
        for each in running:
            each.kill()
            each.wait()
        running.clear()

    return Fault(f"{processes} processes that take all of the processor", begin, end)


def _each_cable(action: str) -> Callable[[ProcessRobot], None]:
    def act(robot: ProcessRobot) -> None:
        for cable in robot.cables:
            getattr(cable, action)()

    return act


LINK_CUT: Final = Fault("link cut", _each_cable("cut"), _each_cable("mend"))
LINK_SEVERED: Final = Fault("link severed", _each_cable("sever"))


def link_delayed(seconds: float) -> Fault:
    def set_delay(robot: ProcessRobot, delay: float) -> None:
        for cable in robot.cables:
            cable.delay = delay

    return Fault(
        f"link delayed by {seconds:g} s",
        _does(lambda robot: set_delay(robot, seconds)),
        lambda robot: set_delay(robot, 0.0),
    )
