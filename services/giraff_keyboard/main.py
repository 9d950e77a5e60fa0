"""Keyboard: keys pressed in a terminal to `cmd_vel/<operator>`.

Reads the terminal, `tick` and `lease`; writes `cmd_vel/<operator>` and asks `estop/engage`. Shows `base`, `guard`,
`estop` and `battery` to the person who drives.
"""

import logging
import socket
import sys
import time
from typing import Any

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.keys import KeyReader
from giraff_keyboard.policy import Key, KeyboardPolicy
from giraff_keyboard.status import Heard
from giraff_keyboard.stopping import Stopping
from giraff_keyboard.terminal import Terminal
from giraff_node import Inbox, Node, Pacer
from giraff_node.asking import ask_to_stop
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, LEASE, OPERATOR_CMD_VEL, TICK

_STATUS_HZ = 10
_LAST_REQUESTS = 2.0  # s that a stop is still asked for after Ctrl-C


class StopNotConfirmedError(Exception):
    """The program ends, and base has not said that the robot is stopped."""


def main() -> int:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        print("giraff_keyboard: reads keys from a terminal; start it in one, without a pipe", file=sys.stderr)
        return 2
    with Node("keyboard", KeyboardConfig) as node:
        if sys.stderr.isatty():
            node.log.setLevel(logging.ERROR)  # the status lines tell the rest, on the same screen
        by = f"{node.config.operator}@{socket.gethostname()}"
        stopping = Stopping(lambda: ask_to_stop(node.session, node.robot.name, by=by, reason="space bar"))
        with Terminal() as terminal:
            _drive(node, terminal, stopping)
        until = time.monotonic() + _LAST_REQUESTS
        while stopping.asked and (now := time.monotonic()) < until:
            stopping.poll(now)
            time.sleep(0.01)
        if stopping.asked:
            node.fail(StopNotConfirmedError(stopping.text))
    return 0


def _drive(node: Node[KeyboardConfig], terminal: Terminal, stopping: Stopping) -> None:
    policy = KeyboardPolicy(node.config, node.robot, node.instance)
    keys, heard = KeyReader(), Heard()
    ticks, leases = node.inbox(TICK, limit=1), node.inbox(LEASE, limit=10)
    told: list[Inbox[Any]] = [node.inbox(topic, limit=10) for topic in (BASE, GUARD, ESTOP, BATTERY)]
    commands = node.publisher(OPERATOR_CMD_VEL.at(node.config.operator))
    pace, status_pace = Pacer(OPERATOR_CMD_VEL.rate_hz), Pacer(_STATUS_HZ)
    for now in node.turns(pace, link=terminal):
        pressed = keys.feed(terminal.read(), now)  # before the ticks: a press is of the newest one before it
        if terminal.is_gone:
            node.log.error("the terminal was closed")
            break
        _take(pressed, policy, stopping, now)
        for tick in ticks.take():
            policy.on_tick(tick, now)
        for lease in leases.take():
            policy.on_lease(lease)
        for sample in (sample for inbox in told for sample in inbox.take()):
            heard.take(sample, now)
            stopping.on_sample(sample)
        if stopping.poll(now):
            policy.on_stopped()
        if pace.due(now) or pressed:
            command = policy.command(now)
            commands.put(command)
            node.set_notice("keys", command.reason)
            node.set_notice("lease", policy.refusal)
        if status_pace.due(now) or pressed:
            terminal.show(heard.lines(policy, stopping.text, now))
    commands.put(policy.farewell())


def _take(pressed: list[Key], policy: KeyboardPolicy, stopping: Stopping, now: float) -> None:
    for key in pressed:
        policy.on_key(key, now)
        if key is Key.STOP:
            stopping.engage()
