"""giraff_base: the robot's clock, and the only writer to the base board."""

from __future__ import annotations

import secrets
import time

from giraff_base.config import BaseConfig
from giraff_base.policy import BasePolicy
from giraff_node import Node, Pacer, robot_now_ns
from giraff_node.board_link import BoardLink
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.topics import BASE, BATTERY, CMD_VEL, TICK, WHEELS
from giraff_schemas.wire import BASE_BAUD, BoardKind


def main() -> None:
    with Node("base", BaseConfig) as node:
        epoch = secrets.randbelow(0xFFFFFFFF) + 1
        policy = BasePolicy(node.config, node.robot)
        link = BoardLink(node.config.port, BASE_BAUD, BoardKind.BASE)
        commands = node.inbox(CMD_VEL)
        ticks, wheels = node.publisher(TICK), node.publisher(WHEELS)
        states, batteries = node.publisher(BASE), node.publisher(BATTERY)
        tick_pace, state_pace, battery_pace = (Pacer(topic.rate_hz) for topic in (TICK, BASE, BATTERY))
        opened, reason = 0, ""

        for now in node.turns(tick_pace, state_pace, link=link):
            if tick_pace.due(now):
                ticks.put(Tick(epoch=epoch, robot_ns=robot_now_ns()))
            frames = link.poll(time.monotonic())
            if link.opened != opened:
                opened = link.opened
                policy.on_link_opened(session=secrets.randbelow(0xFFFFFFFF) + 1)
            if link.fault:
                policy.on_link_lost(link.fault)
            node.set_fault("board", link.fault)
            robot_time = RobotTime(epoch=epoch, robot_ns=robot_now_ns())
            for command in commands.take():
                policy.on_command(command, robot_time)
            for sample in policy.on_frames(frames, robot_time):
                wheels.put(sample)
            if (frame := policy.next_frame(robot_time)) is not None:
                link.send(frame)
            node.set_fault("guard", policy.intruder)
            state = policy.state()
            if state_pace.due(now) or state.reason != reason:
                reason = state.reason
                states.put(state)
            if battery_pace.due(now) and (battery := policy.battery()) is not None:
                batteries.put(battery)


if __name__ == "__main__":
    main()
