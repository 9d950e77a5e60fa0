"""The whole robot in one process and simulated time: the services' policies around boards and world.

Services sit on two machines, the robot's and the operator's, whose network and cables are ideal unless others are
given. The same seed gives the same run, to the byte.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.policy import BasePolicy
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_node.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_ranger.config import RangerConfig
from giraff_ranger.policy import RangerPolicy
from giraff_schemas.wire import BoardKind
from giraff_sim.hosts.agenda import Agenda
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.host import Host
from giraff_sim.hosts.network import Network
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.hosts.services import Base, Guard, Joystick, Odometry, Ranger
from giraff_sim.simulation import Simulation


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """Configuration of the robot and its services."""

    robot: RobotConfig
    joystick: JoystickConfig = JoystickConfig(port="joystick")
    base: BaseConfig = BaseConfig(port="base")
    ranger: RangerConfig = RangerConfig(port="ranger")
    guard: GuardConfig = GuardConfig(deceleration=1.5)
    odometry: OdometryConfig = OdometryConfig()


class Policies(NamedTuple):
    """What decides in each process."""

    joystick: type[JoystickPolicy] = JoystickPolicy
    ranger: type[RangerPolicy] = RangerPolicy
    guard: type[GuardPolicy] = GuardPolicy
    base: type[BasePolicy] = BasePolicy
    odometry: type[OdometryPolicy] = OdometryPolicy


ProcessMaker = Callable[["ClosedLoop", Host, str, int], Process]
"""Makes a process of its host, its instance and a number that no other process has."""

SERVICES: Final[dict[str, tuple[str, ProcessMaker]]] = {
    "joystick": ("operator", Joystick),
    "ranger": ("robot", Ranger),
    "guard": ("robot", Guard),
    "base": ("robot", Base),
    "odometry": ("robot", Odometry),
}
"""By name: the host it runs on, and its process."""


class ClosedLoop:
    """Step it, kill and start services, and look at the newest sample of each key."""

    def __init__(
        self,
        simulation: Simulation,
        settings: Settings,
        policies: Policies | None = None,
        network: Network | None = None,
        observer: Observer | None = None,
        agenda: Agenda | None = None,
    ) -> None:
        self.simulation = simulation
        self.settings = settings
        self.policies = policies or Policies()
        self.network = network or Network()
        self.observer = observer or Observer()
        self.agenda = agenda or Agenda()
        self.hosts = {name: Host(name, self.agenda) for name in ("robot", "operator")}
        self.cables = {
            port: Cable(kind, simulation)
            for kind, port in (
                (BoardKind.BASE, settings.base.port),
                (BoardKind.RANGER, settings.ranger.port),
                (BoardKind.JOYSTICK, settings.joystick.port),
            )
        }
        """By the port's path."""
        self.newest: dict[str, Any] = {}
        """The newest sample that was published, by key as the topics table has it."""
        self.processes: dict[str, Process] = {}
        self._started = 0
        for name in SERVICES:
            self.start(name)

    @property
    def robot_ns(self) -> int:
        """The robot's clock."""
        return self.hosts["robot"].boottime_ns()

    def start(self, name: str) -> None:
        """Start the service `name`, anew if it was killed."""
        host, maker = SERVICES[name]
        self.launch(name, maker, self.hosts[host])

    def launch(self, name: str, maker: ProcessMaker, host: Host) -> Process:
        """Start a process that is called `name` here."""
        self._started += 1
        process = maker(self, host, f"{name}-{self._started}", self._started)
        process.name = name
        self.processes[name] = process
        self.network.join(process)
        process.wake()
        return process

    def kill(self, name: str) -> None:
        """End the process `name` as SIGKILL would."""
        process = self.processes.pop(name)
        process.end()
        self.network.leave(process)

    def step(self) -> None:
        """Advance by a step of the simulation."""
        self.simulation.step()
        for cable in self.cables.values():
            cable.carry()
        self.agenda.run_until(self.simulation.now_us)

    def run(self, seconds: float) -> None:
        end = self.simulation.now_us + round(seconds * 1e6)
        while self.simulation.now_us < end:
            self.step()
