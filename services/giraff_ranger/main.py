"""Ranger: ultrasonic pings to `range/<sensor>`.

Reads the ranger board and `tick`, which it hands down to the board; writes `range/<sensor>`. While the board is
silent so is this service: what that means for the robot is the guard's to judge.
"""

from giraff_node import Node
from giraff_node.board_link import BoardLink
from giraff_ranger.config import RangerConfig
from giraff_ranger.policy import RangerPolicy
from giraff_schemas.topics import RANGE, TICK
from giraff_schemas.wire import RANGER_BAUD, BoardKind, RangeFrame


def main() -> None:
    with Node("ranger", RangerConfig) as node:
        link = BoardLink(node.config.port, RANGER_BAUD, BoardKind.RANGER)
        policy = RangerPolicy(node.robot)
        ticks = node.inbox(TICK, limit=1)
        for transform in policy.transforms():
            node.frame(transform.child, transform)
        ranges = {name: node.publisher(RANGE.at(name)) for name in node.robot.sensors}
        for now in node.turns(link=link):
            for frame in link.poll(now):
                if isinstance(frame, RangeFrame) and (sample := policy.on_frame(frame)) is not None:
                    ranges[sample.sensor].put(sample)
            for tick in ticks.take():
                if (down := policy.on_tick(tick, now)) is not None:
                    link.send(down)
            for name, message in (("board", link.fault), *policy.faults.items()):
                node.set_fault(name, message)
