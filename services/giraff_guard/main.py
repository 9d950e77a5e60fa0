"""giraff_guard: cmd_vel/<operator> + range/* -> cmd_vel."""

from __future__ import annotations

import secrets

from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_node import Node, Pacer, robot_now_ns
from giraff_schemas.topics import CMD_VEL, GUARD, LEASE, OPERATOR_CMD_VEL, RANGE, TICK, WHEELS


def main() -> None:
    with Node("guard", GuardConfig, steady=True) as node:
        policy = GuardPolicy(node.config, node.robot, first_lease=secrets.randbits(32))
        node.on_reconfigured = policy.reconfigure
        # All of each, and not the newest: of two makers who speak in turn, the newest may always be the same one's.
        ticks, ranges = node.inbox(TICK), node.inbox(RANGE)
        wheels, commands = node.inbox(WHEELS), node.inbox(OPERATOR_CMD_VEL)
        guarded, states, leases = node.publisher(CMD_VEL), node.publisher(GUARD), node.publisher(LEASE)
        pace, state_pace, lease_pace = (Pacer(topic.rate_hz) for topic in (CMD_VEL, GUARD, LEASE))
        reason, counter = "", 0

        for now in node.turns(pace):
            if not pace.due(now):
                continue
            for tick in ticks.take():
                policy.on_tick(tick, robot_now_ns())
            for reading in ranges.take():
                policy.on_range(reading, robot_now_ns())
            for report in wheels.take():
                policy.on_wheels(report, robot_now_ns())
            for command in commands.take():
                policy.on_command(command, robot_now_ns())
            passed, state, lease = policy.decide(robot_now_ns())
            guarded.put(passed)
            node.set_notice("identity", policy.fault)
            if lease.counter != counter or lease_pace.due(now):
                counter = lease.counter
                leases.put(lease)
            if state.reason != reason or state_pace.due(now):
                reason = state.reason
                states.put(state)


if __name__ == "__main__":
    main()
