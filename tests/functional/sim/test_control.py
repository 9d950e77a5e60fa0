"""The control socket, served by a thread of its own as the simulator serves it."""

import math
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_schemas.wire import Wiring
from giraff_sim.control.client import SimulatorClient, SimulatorError
from giraff_sim.control.control import Control
from giraff_sim.control.server import ControlServer
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.world.hand import Hand, StillHand
from giraff_sim.world.sonar import SonarFault
from tests.sim.robots import ORIGIN, room_with_wall, world_in
from tests.support.wheels import wheels_of


@pytest.fixture
def simulation() -> Simulation:
    """A world without boards."""
    return Simulation({}, world_in(room_with_wall(2.0)))


@pytest.fixture
def control(simulation: Simulation) -> Control:
    def make_hand(_name: str, begin: float) -> Hand:
        return StillHand((begin, 0.0, 0.0))

    return Control(simulation, {}, WallPacer(), make_hand)


@pytest.fixture
def socket_path(tmp_path: Path, control: Control) -> Iterator[Path]:
    """A control socket that is served until the test is over."""
    path = tmp_path / "deep" / "control"
    server = ControlServer(path, control.answer)
    over = threading.Event()

    def serve() -> None:
        clients: list[int] = []
        while not over.wait(0.002):
            if (client := server.accept()) is not None:
                clients.append(client)
            for descriptor in list(clients):
                try:
                    if not server.serve(descriptor):
                        clients.remove(descriptor)
                except BlockingIOError:
                    continue

    thread = threading.Thread(target=serve)
    thread.start()
    yield path
    over.set()
    thread.join()
    server.close()
    assert not path.exists()


def test_a_client_speaks_in_types(socket_path: Path, simulation: Simulation) -> None:
    with SimulatorClient(socket_path) as client:
        assert client.now() == 0
        assert client.place(0.5, 0.0, math.pi) == 0
        assert client.state().yaw == math.pi
        assert client.truth() == simulation.world.truth
        assert client.record().driven_ms == 0
        client.add_wall("box", [(3.0, 0.0), (4.0, 0.0), (4.0, 1.0)], closed=True)
        client.remove_wall("box")
        client.tilt(1.0, 2.0)
        client.button(pressed=True)
        client.fail_sonar(1, SonarFault.WILD)
        client.fail_sonar(2, SonarFault.WILD_SOME, 0.05)
        with pytest.raises(SimulatorError, match="no bumper 0"):
            client.cut_bumper(0, cut=True)
        client.block_wheel("left", blocked=True)
        client.battery(23.0)
        with pytest.raises(SimulatorError, match="no base board here"):
            client.reset("base")
        with pytest.raises(SimulatorError, match="no base board here"):
            client.rewire(Wiring.SWAP_MOTORS)
        assert client.now() == 0  # and goes on
    assert simulation.world.sonars[1].fault is SonarFault.WILD
    assert simulation.world.sonars[2].wild_share == 0.05
    assert wheels_of(simulation.world).plant.left.is_blocked
    assert simulation.world.plant.pose == (*ORIGIN[:0], 0.5, 0.0, math.pi)


def test_several_clients_at_once(socket_path: Path) -> None:
    with SimulatorClient(socket_path) as one, SimulatorClient(socket_path) as other:
        assert one.now() == other.now() == 0
