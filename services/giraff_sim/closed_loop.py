"""The whole robot in one process and simulated time: the services themselves around boards and world.

Services sit on two machines, the robot's and the operator's, whose network and cables are ideal unless others are
given. `motion` runs where it is started. The same seed gives the same run, to the byte.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from giraff_core.io import Service
from giraff_schemas.wire import BoardKind
from giraff_sim.hosts.cable import BoardUart, Cable
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.host import Host
from giraff_sim.hosts.network import Network
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.settings import MACHINES, STARTED, Services, Settings
from giraff_sim.simulation import Simulation


class ClosedLoop:
    """Step it, kill and start services, and look at the newest sample of each key."""

    def __init__(
        self,
        simulation: Simulation,
        settings: Settings,
        services: Services | None = None,
        network: Network | None = None,
        observer: Observer | None = None,
        agenda: EventQueue | None = None,
    ) -> None:
        self.simulation = simulation
        self.settings = settings
        self.services = services or Services()
        self.network = network or Network()
        self.observer = observer or Observer()
        self.agenda = agenda or EventQueue()
        self.hosts = {name: Host(name, self.agenda) for name in ("robot", "operator")}
        self.cables = {
            port: Cable(BoardUart(kind, simulation), simulation, frames=True)
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
        for name in STARTED:
            self.start(name)

    @property
    def robot_ns(self) -> int:
        """The robot's clock."""
        return self.hosts["robot"].boottime_ns()

    def start(self, service: str, name: str = "") -> Process:
        """Start a service, anew if it was killed; under another `name` beside the one that runs."""
        return self.launch(name or service, partial(self._make, service), self.hosts[MACHINES[service]])

    def launch(self, name: str, make: Callable[[Process], Service], host: Host) -> Process:
        """Start a process that is called `name` here."""
        self._started += 1
        process = self.processes[name] = Process(self, host, name, f"{name}-{self._started}")
        process.run(make(process))
        return process

    def kill(self, name: str) -> None:
        """End the process `name` as SIGKILL would."""
        process = self.processes.pop(name)
        process.end()
        self.network.leave(process)

    def terminate(self, name: str) -> None:
        """End the process `name` as SIGTERM would, with its last words."""
        self.processes[name].terminate()
        self.kill(name)

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

    def _make(self, service: str, process: Process) -> Service:
        filed = getattr(self.settings, service)
        config = process.parameters(service, filed, self.settings.robot)
        made: Service = getattr(self.services, service)(process, config, self.settings.robot)
        return made
