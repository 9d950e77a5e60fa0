"""giraff_guard: cmd_vel/<operator> + range/* -> cmd_vel."""

from __future__ import annotations

from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_node import Node, Pacer, robot_now_ns
from giraff_schemas.topics import CMD_VEL, GUARD, OPERATOR_CMD_VEL, RANGE, TICK, WHEELS


def main() -> None:
    with Node("guard", GuardConfig) as node:
        policy = GuardPolicy(node.config, node.robot)
        commands, ranges = node.inbox(OPERATOR_CMD_VEL), node.inbox(RANGE)
        ticks, wheels = node.newest(TICK), node.newest(WHEELS)
        guarded, states = node.publisher(CMD_VEL), node.publisher(GUARD)
        pace, state_pace = Pacer(CMD_VEL.rate_hz), Pacer(GUARD.rate_hz)
        reason = ""

        for now in node.turns(pace):
            if not pace.due(now):
                continue
            if ticks.value is not None:
                policy.on_tick(ticks.value)
            if wheels.value is not None:
                policy.on_wheels(wheels.value)
            for reading in ranges.take():
                policy.on_range(reading)
            for command in commands.take():
                policy.on_command(command, robot_now_ns())
            passed, state = policy.decide(robot_now_ns())
            guarded.put(passed)
            if state_pace.due(now) or state.reason != reason:
                reason = state.reason
                states.put(state)


if __name__ == "__main__":
    main()
