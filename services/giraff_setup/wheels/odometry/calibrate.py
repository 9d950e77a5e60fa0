"""`giraff calibrate odometry`, guided: a person drives and measures, and the robot file is told what was found."""

import math
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import is_simulated_here, others
from giraff_schemas.messages import Sample, Wheels
from giraff_schemas.topics import WHEELS, Topic
from giraff_setup.wheels.odometry.conclusion import conclude, refuse
from giraff_setup.wheels.odometry.procedure import Procedure, WheelSource
from giraff_setup.wheels.odometry.runs import Geometry
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_base
from giraff_tools.robot_file import own_robot_file
from giraff_tools.terminal.document import INTERRUPTED, UNUSABLE, Report, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, introduce, signals_interrupt

_PATIENCE: Final = 3.0  # s

_THEN: Final = (
    "Nothing goes by it yet: copy the file to the robot's other machines, let the robot stand, and restart its "
    "services.\n`giraff doctor` names those that still go by another geometry."
)
_THEN_SIMULATED: Final = "Nothing goes by it yet: end `giraff run` and start it again."
_TURN: Final = 0.02  # s
_COMPARED: Final = ("track_width", "ticks_per_metre")
"""What scales are factors of."""


def calibrate_odometry(
    robot: str | None, connect: Sequence[str], file: Path | None, *, force: bool, as_json: bool
) -> int:
    """Do the whole command; return its exit code.

    `file`: as of `own_robot_file`. `force`: scales may be far from before. `as_json`: the talk goes to standard error.
    """
    return print_report(lambda report: _calibrate(robot, connect, file, report, force=force), as_json=as_json)


def _calibrate(robot: str | None, connect: Sequence[str], file: Path | None, report: Report, *, force: bool) -> int:
    def act(connection: RobotConnection) -> int:
        human = Terminal(sys.stdin, sys.stdout)
        try:
            path, filed = own_robot_file(connection.robot, file)
            wheels = NetworkWheels(connection)
            if not wheels.wait(_PATIENCE):
                return refuse(_unheard(connection), UNUSABLE)
            introduce(human, connection.robot, path)
            for words in differences(connection, filed):
                human.show(f"{words}: what is found holds for the value of the file.")
            return guide(human, wheels, connection.robot, filed, path, force=force, report=report)
        except ConfigError as error:
            return refuse(str(error), UNUSABLE)
        except KeyboardInterrupt:
            return _interrupted()

    with signals_interrupt():
        try:
            return run_with_robot(robot, connect, act, stands_in=False)  # it writes into the file
        except KeyboardInterrupt:  # before a robot was found
            return _interrupted()


def guide(
    human: Human,
    source: WheelSource,
    robot: str,
    filed: RobotConfig,
    path: Path,
    *,
    force: bool,
    report: Report = no_report,
) -> int:
    """From the first mark to the robot file at `path`, which says `filed`; the exit code."""
    geometry = Geometry(filed.ticks_per_metre, filed.track_width, filed.calibration.scales)
    try:
        measured = Procedure(human, source, geometry).measure()
        conclusion = conclude(
            measured.fitted,
            measured.checks,
            geometry,
            path,
            force=force,
            tell=human.show,
            agrees=lambda: agrees(human, f"Write into {path}? [yes/no]"),
            then=_THEN_SIMULATED if is_simulated_here(robot) else _THEN,
        )
    except NobodyError:
        return refuse("nobody answers. Nothing was written.", UNUSABLE)
    if conclusion.outcome:
        report(conclusion.outcome)
    return conclusion.code


def _unheard(connection: RobotConnection) -> str:
    robot = connection.robot
    hint = others(connection.session, robot)
    return f"no wheels of {robot} are heard; check that giraff_base runs, and the network to it{hint}"


def _interrupted() -> int:
    return refuse("interrupted. Nothing was written.", INTERRUPTED)


class NetworkWheels:
    """Hears the wheels of a robot on the network."""

    def __init__(self, connection: RobotConnection) -> None:
        self._connection = connection
        self._waiting: list[Wheels] = []
        self._heard_at = -math.inf
        connection.subscribe(WHEELS)

    def wait(self, patience: float) -> bool:
        """Whether any come within so many s. They stay to be polled."""
        deadline = time.monotonic() + patience
        while not self._waiting and time.monotonic() < deadline:
            self._connection.dispatch(self)
            time.sleep(_TURN)
        return bool(self._waiting)

    def poll(self) -> list[Wheels]:
        """What came since the last call."""
        self._connection.dispatch(self)
        heard, self._waiting = self._waiting, []
        return heard

    @property
    def silence(self) -> float:
        """s since the last one came; infinite where none has."""
        return time.monotonic() - self._heard_at

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As a `Listener`."""
        del topic, key, at_ns
        if isinstance(sample, Wheels):
            self._waiting.append(sample)
            self._heard_at = time.monotonic()

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Wheels that are silent say it."""


def differences(connection: RobotConnection, robot: RobotConfig) -> list[str]:
    """Return how the robot file differs from what the robot that runs says, in words. Empty where base is silent."""
    answer = ask_base(connection).wait(time.monotonic() + _PATIENCE)
    told = {param.name.removeprefix("robot."): param.value for param in answer.params} if answer else {}
    return [
        f"{name} is {getattr(robot, name):g} in the robot file of this machine and {told[name]} in the robot"
        for name in _COMPARED
        if name in told and told[name] != getattr(robot, name)
    ]
