"""giraff_base: the robot's clock, and the only writer to the base board."""

from __future__ import annotations

import secrets
import time
from functools import partial

from giraff_base.config import BaseConfig
from giraff_base.estop_desk import EStopDesk
from giraff_base.policy import BasePolicy
from giraff_node import Node, Pacer, robot_now_ns
from giraff_node.board_link import BoardLink
from giraff_node.state import LatchSaver, read_latch, state_directory, write_latch
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.topics import BASE, BATTERY, CMD_VEL, ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK, WHEELS
from giraff_schemas.wire import BASE_BAUD, BoardKind


def main() -> None:
    with Node("base", BaseConfig, steady=True) as node:
        epoch = secrets.randbelow(0xFFFFFFFF) + 1
        directory = state_directory(node.robot.name)
        policy = BasePolicy(node.config, node.robot, read_latch(directory))
        node.on_reconfigured = policy.reconfigure
        desk = EStopDesk(policy, LatchSaver(partial(write_latch, directory)))
        link = BoardLink(node.config.port, BASE_BAUD, BoardKind.BASE)
        commands, engages, resets = node.inbox(CMD_VEL), node.requests(ESTOP_ENGAGE), node.requests(ESTOP_RESET)
        ticks, wheels, states = node.publisher(TICK), node.publisher(WHEELS), _States(node, policy)
        tick_pace = Pacer(TICK.rate_hz)
        opened = 0

        for now in node.turns(tick_pace, link=link):
            if tick_pace.due(now):
                ticks.put(Tick(epoch=epoch, robot_ns=robot_now_ns()))
            frames = link.poll(time.monotonic())
            if link.opened != opened:
                opened = link.opened
                policy.on_link_opened(session=secrets.randbelow(0xFFFFFFFF) + 1)
            if link.fault:
                policy.on_link_lost(link.fault)
            robot_time = RobotTime(epoch=epoch, robot_ns=robot_now_ns())
            for command in commands.take():
                policy.on_command(command, robot_time)
            for sample in policy.on_frames(frames, robot_time):
                wheels.put(sample)
            desk.take(engages.take(), resets.take(), robot_time)
            if (frame := policy.next_frame(robot_time)) is not None:
                link.send(frame)
            desk.turn(robot_time)
            node.set_fault("board", link.fault)
            node.set_fault("estop", desk.fault)
            for name, message in policy.faults.items():  # of the robot, and of a second guard
                node.set_notice(name, message)
            states.put(now)


class _States:
    """Publishes what base says of itself: at its rates, and at once what changes."""

    def __init__(self, node: Node[BaseConfig], policy: BasePolicy) -> None:
        self._policy = policy
        self._base, self._estop, self._battery = node.publisher(BASE), node.publisher(ESTOP), node.publisher(BATTERY)
        self._base_pace, self._estop_pace, self._battery_pace = (Pacer(row.rate_hz) for row in (BASE, ESTOP, BATTERY))
        self._reason = ""
        self._latch = policy.latch

    def put(self, now: float) -> None:
        """`now`: monotonic, s."""
        policy = self._policy
        state = policy.state()
        if self._base_pace.due(now) or state.reason != self._reason:
            self._reason = state.reason
            self._base.put(state)
        if self._estop_pace.due(now) or policy.latch != self._latch:
            self._latch = policy.latch
            self._estop.put(policy.estop())
        if self._battery_pace.due(now) and (battery := policy.battery()) is not None:
            self._battery.put(battery)


if __name__ == "__main__":
    main()
