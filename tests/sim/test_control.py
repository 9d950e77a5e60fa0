"""The control protocol: every request does what it says, and nonsense gets an answer."""

import json
import socket
from pathlib import Path
from typing import Any

import pytest

from giraff_schemas.boards import BASE_BOARD
from giraff_sim.bodies.registry import world_of
from giraff_sim.control import messages
from giraff_sim.control.client import SimulatorClient, SimulatorError
from giraff_sim.control.control import Control
from giraff_sim.control.server import ControlServer
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.truth import TruthRanges, draw_truth
from giraff_sim.world.hand import Hand, StillHand
from giraff_sim.world.sonar import SonarFault
from tests.sim.robots import EXACT, room_with_wall, world_in
from tests.support.robots import BUMPED, DRIVE, ROBOT
from tests.support.wheels import wheels_of


@pytest.fixture
def simulation() -> Simulation:
    """A world without boards."""
    return Simulation({}, world_in(room_with_wall(2.0)))


def make_hand(name: str, begin: float) -> Hand:
    if name == "tired":
        raise ValueError("no such hand")
    return StillHand((begin, 0.0, 0.0))


@pytest.fixture
def control(simulation: Simulation) -> Control:
    return Control(simulation, {}, WallPacer(), make_hand)


def test_a_wheel_is_held_back_and_let_go(control: Control, simulation: Simulation) -> None:
    plant = wheels_of(simulation.world).plant
    assert ask(control, op="brake", wheel="right", brake=2.5).ok
    assert (plant.left.brake, plant.right.brake) == (0.0, 2.5)
    assert ask(control, op="brake", wheel="right", brake=0.0).ok
    assert plant.right.brake == 0.0
    assert ask(control, op="brake", wheel="left", brake=-1.0).error


def test_an_encoder_loses_counts_and_is_mended(control: Control, simulation: Simulation) -> None:
    left = wheels_of(simulation.world).plant.left
    assert ask(control, op="encoder_slip", wheel="left", lost_share=0.5).ok
    left.speed = 0.4
    simulation.run(0.1)
    assert 0.0 < left.counted_speed == pytest.approx(left.speed / 2.0)
    assert left.states == pytest.approx(left.travel / 2.0 * ROBOT.ticks_per_metre * BASE_BOARD.states_per_tick)
    counted, travel = left.states, left.travel
    assert ask(control, op="encoder_slip", wheel="left", lost_share=0.0).ok
    simulation.run(0.02)
    turned = (left.travel - travel) * ROBOT.ticks_per_metre
    assert left.states - counted == pytest.approx(turned * BASE_BOARD.states_per_tick)
    assert "below 1" in ask(control, op="encoder_slip", wheel="left", lost_share=1.0).error


def ask(control: Control, **request: Any) -> messages.Reply:
    return control.answer(json.dumps(request).encode())


def test_now_and_state(simulation: Simulation, control: Control) -> None:
    simulation.run(0.25)
    assert ask(control, op="now") == messages.Reply(ok=True, now_us=250_000)
    state = ask(control, op="state").state
    assert state is not None
    assert (state.x, state.y, state.yaw, state.path_length) == (0.0, 0.0, 0.0, 0.0)
    assert state.clearance == pytest.approx(1.7)
    assert state.closest == pytest.approx(1.7)
    assert state.battery_volts == 24.0
    assert state.boards == {}
    assert state.base is None


def test_the_truth_is_the_robots_whose_world_it_is() -> None:
    truth = draw_truth("uncalibrated", TruthRanges(), 3)
    simulation = Simulation({}, world_in(room_with_wall(2.0), truth=truth))
    control = Control(simulation, {}, WallPacer(), make_hand)
    assert ask(control, op="truth").truth == truth
    plant = simulation.world.plant
    plant.left.speed, plant.right.speed = 0.2, 0.3
    simulation.run(0.001)
    state = ask(control, op="state").state
    assert state is not None
    assert (state.speed, state.turn) == (plant.speed, plant.turn)
    assert state.speed == pytest.approx(0.25, abs=0.01)
    assert state.turn == pytest.approx(0.1 / 0.47 / truth.track_scale, rel=0.05)


def test_place_and_walls(simulation: Simulation, control: Control) -> None:
    assert ask(control, op="place", x=-1.0, y=0.5, yaw=1.0).ok
    assert simulation.world.plant.pose == (-1.0, 0.5, 1.0)
    assert ask(control, op="add_wall", name="screen", points=[[0, -1], [0, 1]]).ok
    assert simulation.world.plant.clearance == pytest.approx(0.7)
    assert ask(control, op="remove_wall", name="screen").ok
    assert simulation.world.plant.clearance == pytest.approx(2.7)


def test_tilt_hand_and_button(simulation: Simulation, control: Control) -> None:
    assert ask(control, op="tilt", x=4.0, y=-1.0, z=8.0).ok
    simulation.run(0.01)
    assert simulation.world.acceleration == pytest.approx((4.0, -1.0, 8.0), abs=0.2)  # the hand trembles
    assert ask(control, op="hand", hand="demo").ok
    simulation.run(0.01)
    assert simulation.world.acceleration == pytest.approx((0.01, 0.0, 0.0), abs=0.2)
    assert ask(control, op="button", pressed=True).ok
    assert simulation.world.button


def test_a_bumpers_wire_is_cut_and_mended() -> None:
    world = world_of(room_with_wall(2.0), BUMPED, DRIVE, EXACT, StillHand(), 1)
    control = Control(Simulation({}, world), {}, WallPacer(), make_hand)
    for cut in (True, False):
        assert ask(control, op="bumper", number=1, cut=cut).ok
        assert [world.bumpers[number].is_cut for number in (0, 1)] == [False, cut]


def test_faults(simulation: Simulation, control: Control) -> None:
    assert ask(control, op="sonar", number=2, fault="stuck").ok
    assert simulation.world.sonars[2].fault is SonarFault.STUCK
    assert ask(control, op="sonar", number=1, fault="wild_some", wild_share=0.05).ok
    assert simulation.world.sonars[1].fault is SonarFault.WILD_SOME
    assert simulation.world.sonars[1].wild_share == 0.05
    assert ask(control, op="block", wheel="right", blocked=True).ok
    plant = wheels_of(simulation.world).plant
    assert (plant.left.is_blocked, plant.right.is_blocked) == (False, True)
    assert ask(control, op="battery", volts=21.5).ok
    simulation.run(0.001)
    assert simulation.world.plant.volts == 21.5


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        (b"", "not a request"),
        (b"hello", "not a request"),
        (b"\xff\xfe", "not a request"),
        (b"[1]", "not a request"),
        (b'{"x": 1}', "`op` is missing"),
        (b'{"op": "fly"}', "op cannot be 'fly'"),
        (b'{"op": "place", "x": 1}', "`y` is missing"),
        (b'{"op": "place", "x": 1, "y": 2, "w": 3}', "unknown field `w`"),
        (b'{"op": "place", "x": 1e999, "y": 2}', "not a request"),
        (b'{"op": "sonar", "number": 7, "fault": "dead"}', "no sonar 7; there are [0, 1, 2]"),
        (b'{"op": "bumper", "number": 0, "cut": true}', "no bumper 0; there are []"),
        (b'{"op": "sonar", "number": 0, "fault": "sad"}', "fault cannot be 'sad'"),
        (b'{"op": "remove_wall", "name": "sofa"}', "no wall or post 'sofa'; there are wall"),
        (b'{"op": "add_wall", "name": "w", "points": [[0, 1]]}', "needs two or more"),
        (b'{"op": "hand", "hand": "tired"}', "no such hand"),
        (b'{"op": "battery", "volts": -1}', "cannot have -1"),
        (b'{"op": "bno055", "fault": "dead"}', "no joystick here"),
        (b'{"op": "encoder", "wheel": "left", "cut": true}', "no base board here"),
        (b'{"op": "sonar", "number": 0, "fault": "wild_some", "wild_share": 1.5}', "must be in 0..1"),
        (b'{"op": "block", "wheel": "front", "blocked": true}', "wheel cannot be 'front'"),
        (b'{"op": "rewire", "wiring": 64}', "wiring must be at most 63"),
        (b'{"op": "rewire", "wiring": 63}', "no base board here"),
        (b'{"op": "unplug", "board": "base"}', "no base board here"),
        (b'{"op": "record", "since_us": 5, "until_us": 4}', "before it begins"),
    ],
)
def test_nonsense_gets_an_answer(control: Control, line: bytes, complaint: str) -> None:
    reply = control.answer(line)
    assert not reply.ok
    assert complaint in reply.error


def test_a_missing_simulator_is_named(tmp_path: Path) -> None:
    with pytest.raises(SimulatorError, match=r"no simulator at .*nowhere"):
        SimulatorClient(tmp_path / "nowhere")


def test_whoever_sees_the_socket_can_ask_there(
    tmp_path: Path, control: Control, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "control"
    seen: list[bool] = []
    listen = socket.socket.listen

    def late(listener: socket.socket) -> None:
        seen.append(path.exists())
        listen(listener)

    monkeypatch.setattr(socket.socket, "listen", late)
    ControlServer(path, control.answer).close()
    assert seen == [False]


def test_a_path_that_is_taken_by_a_directory_is_named_and_left(tmp_path: Path, control: Control) -> None:
    path = tmp_path / "control"
    path.mkdir()
    with pytest.raises(ValueError, match="cannot be a control socket"):
        ControlServer(path, control.answer)
    assert list(tmp_path.iterdir()) == [path]


def test_a_path_that_is_too_long_for_a_socket_is_named(tmp_path: Path, control: Control) -> None:
    path = tmp_path / ("x" * 120)
    with pytest.raises(ValueError, match="cannot be a control socket"):
        ControlServer(path, control.answer)
