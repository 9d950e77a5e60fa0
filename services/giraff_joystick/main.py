"""Joystick: tilt in the hand to `cmd_vel/<operator>`.

Reads the joystick board, `lease`, and `tick`, which it hands down to the board; writes `tilt` and
`cmd_vel/<operator>`.
"""

from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_node import Node, Pacer
from giraff_node.board_link import BoardLink
from giraff_schemas.topics import LEASE, OPERATOR_CMD_VEL, TICK, TILT
from giraff_schemas.wire import JOYSTICK_BAUD, BoardKind, TiltFrame


def main() -> None:
    with Node("joystick", JoystickConfig) as node:
        link = BoardLink(node.config.port, JOYSTICK_BAUD, BoardKind.JOYSTICK)
        policy = JoystickPolicy(node.config, node.robot, node.instance)
        node.on_reconfigured = policy.reconfigure
        ticks, leases = node.inbox(TICK, limit=1), node.inbox(LEASE, limit=10)
        tilts = node.publisher(TILT)
        commands = node.publisher(OPERATOR_CMD_VEL.at(node.config.operator))
        pace = Pacer(OPERATOR_CMD_VEL.rate_hz)
        for now in node.turns(pace, link=link):
            for frame in link.poll(now):
                if isinstance(frame, TiltFrame):
                    tilts.put(policy.on_frame(frame, now))
            for lease in leases.take():
                policy.on_lease(lease)
            for tick in ticks.take():
                if (down := policy.on_tick(tick, now)) is not None:
                    link.send(down)
            if pace.due(now):
                command = policy.command(now)
                commands.put(command)
                if (lost := policy.lost(now)) is not None:
                    tilts.put(lost)
                node.set_fault("board", link.fault)
                node.set_fault("sensor", policy.sensor_fault)
                node.set_notice("hand", "" if policy.sensor_fault else command.reason)
                node.set_notice("lease", policy.refusal)
        commands.put(policy.farewell())
