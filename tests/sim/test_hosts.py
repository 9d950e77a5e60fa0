"""The machines of the simulation: clocks, agenda, cables and processes do what Linux and the real loops do."""

from functools import partial
from random import Random
from typing import Any

import pytest

from giraff_schemas.messages import Tick
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import BoardKind, HelloRequestFrame
from giraff_sim.board import Implementation
from giraff_sim.dst.network import FaultyNetwork
from giraff_sim.hosts.cable import BoardUart, Cable, CableEnd
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.host import Host
from giraff_sim.hosts.network import Message, Subscription
from giraff_sim.simulation import Simulation, simulation
from tests.loop.loops import arm, closed_loop
from tests.sim.robots import empty_room, world_in


def at(agenda: EventQueue, seconds: float) -> None:
    agenda.run_until(round(seconds * 1e6))


def test_things_happen_in_the_order_of_their_times_then_of_their_planning() -> None:
    agenda = EventQueue()
    done: list[str] = []
    for name, us in (("late", 30), ("first", 10), ("second", 10)):
        agenda.at(us, partial(done.append, name))
    agenda.at(10, lambda: agenda.at(0, lambda: done.append("at once")))
    agenda.run_until(20)
    assert done == ["first", "second", "at once"]
    agenda.run_until(30)
    assert done[-1] == "late"


def test_a_suspended_machine_knows_by_boottime_only() -> None:
    agenda = EventQueue()
    host = Host("robot", agenda)
    monotonic, boottime = host.monotonic(), host.boottime_ns()
    at(agenda, 2.0)
    host.suspend()
    at(agenda, 5.0)
    assert host.monotonic() - monotonic == pytest.approx(2.0)
    host.resume()
    at(agenda, 6.0)
    assert host.monotonic() - monotonic == pytest.approx(3.0)
    assert host.boottime_ns() - boottime == 6_000_000_000


def test_a_wall_clock_is_as_wrong_as_it_is_set() -> None:
    agenda = EventQueue()
    right, wrong = Host("right", agenda), Host("wrong", agenda)
    wrong.wall_ahead_ns, wrong.wall_drift = -3_600_000_000_000, 1e-3
    at(agenda, 10.0)
    assert wrong.wall_ns() - right.wall_ns() == -3_600_000_000_000 + 10_000_000


def ends(running: Simulation) -> tuple[Cable, CableEnd, CableEnd]:
    cable = Cable(BoardUart(BoardKind.BASE, running), running, frames=True)
    first, second = (CableEnd("port", 115200, cable, lambda: None) for _ in range(2))
    return cable, first, second


def test_one_process_at_a_time_has_the_port() -> None:
    with simulation(world_in(empty_room()), implementation=Implementation.HOST) as running:
        _, first, second = ends(running)
        assert first.keep_open(0.0)
        assert not second.keep_open(0.0)
        assert "in use by another process" in str(second.fault)
        first.close(Trouble("ended"))
        assert not second.keep_open(0.05), "it is not tried all the time"
        assert second.keep_open(0.1)
        assert second.fault == NO_TROUBLE


def test_an_unplugged_port_says_so_and_comes_back() -> None:
    with simulation(world_in(empty_room()), implementation=Implementation.HOST) as running:
        cable, end, _ = ends(running)
        assert end.keep_open(0.0)
        cable.unplug()
        assert end.read() == b""
        assert "unplugged" in str(end.fault)
        assert not end.keep_open(0.2)
        assert "no such port" in str(end.fault)
        cable.plug()
        assert end.keep_open(0.4)
        assert end.opened == 2


def test_a_held_cable_keeps_all_and_gives_it_up_at_once() -> None:
    with simulation(world_in(empty_room()), implementation=Implementation.HOST) as running:
        cable, end, _ = ends(running)
        end.keep_open(0.0)
        cable.holds_to_board = cable.holds_to_host = True
        for _ in range(200):
            running.step()
            cable.carry()
        assert end.read() == b""
        end.send(HelloRequestFrame(seq=1).pack())
        assert running.boards[BoardKind.BASE].model.rx_total == 0
        cable.holds_to_board = cable.holds_to_host = False
        cable.carry()
        assert len(end.read()) > 19 * 40
        for _ in range(20):
            running.step()
        assert running.boards[BoardKind.BASE].model.rx_total == 3


def test_a_paused_process_hears_all_of_it_afterwards() -> None:
    with closed_loop(empty_room()) as loop:
        arm(loop)
        guard = loop.processes["guard"]
        before = loop.newest["cmd_vel"].seq
        guard.paused = True
        loop.run(0.5)
        assert loop.newest["cmd_vel"].seq == before
        guard.paused = False
        guard.go_on()
        loop.run(0.1)
        assert before < loop.newest["cmd_vel"].seq <= before + 6


def test_two_machines_are_apart_and_one_is_not() -> None:
    agenda = EventQueue()
    heard: list[tuple[str, int]] = []

    class Taker:
        def __init__(self, name: str) -> None:
            self.host = Host(name, agenda)

        def receive(self, subscription: Subscription, message: Message) -> None:
            assert (subscription.key, message) == ("tick", tick)
            heard.append((self.host.name, agenda.now_us))

    network = FaultyNetwork(agenda, Random(1))
    robot: Any = Taker("robot")
    operator: Any = Taker("operator")
    for taker in (robot, operator):
        network.join(Subscription(taker, "tick", lambda _: None))
    tick = Message("tick", Tick(epoch=1, robot_ns=5))
    network.publish(robot, tick)
    assert [each[0] for each in heard] == ["robot"]
    agenda.run_until(100_000)
    assert [each[0] for each in heard] == ["robot", "operator"]
    link = network.link(robot.host, operator.host)
    link.cut = "holds"
    network.publish(robot, tick)
    agenda.run_until(5_000_000)
    assert len(heard) == 3
    network.mend(link)
    agenda.run_until(5_100_000)
    assert heard[-1][0] == "operator"
    link.cut = "loses"
    network.publish(robot, tick)
    network.mend(link)
    agenda.run_until(9_000_000)
    assert len(heard) == 5
