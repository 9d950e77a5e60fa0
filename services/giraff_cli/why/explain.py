"""`giraff why`: listen for a moment, and say what stops the robot."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import Final

import msgspec
import zenoh
from rich.table import Table
from rich.text import Text

from giraff_cli.network.command import complain
from giraff_cli.network.connection import Watcher
from giraff_cli.terminal.page import Page
from giraff_cli.why.chain import Standing
from giraff_cli.why.diagnosis import Diagnosis, diagnose
from giraff_cli.why.observation import Evidence
from giraff_node import robot_now_ns
from giraff_node.network.discovery import robots_alive, unheard
from giraff_schemas.messages import Health
from giraff_schemas.topics import health_key

_DRIVES: Final = 0
_STOPPED: Final = 1
_FIRST_WITHIN: Final = 3.0  # s until the first word of a robot that is there
_LOOK_EVERY: Final = 0.05  # s
_STYLES: Final[dict[Standing, str]] = {
    "ok": "green",
    "limits": "yellow",
    "waits": "dim",
    "STOPS": "bold red",
    "missing": "bold red",
}


def explain(watcher: Watcher, seconds: float, *, as_json: bool) -> int:
    """Listen for `seconds`, print what was found; the exit code."""
    evidence = listen(watcher, seconds)
    if evidence.empty:
        return complain(unheard(watcher.robot, robots_alive(watcher.session)))
    diagnosis = diagnose(evidence)
    if as_json:
        print(msgspec.json.format(msgspec.json.encode(diagnosis), indent=2).decode())
    else:
        _show(diagnosis, watcher.complaints)
    return _STOPPED if diagnosis.stopped_by else _DRIVES


def listen(watcher: Watcher, seconds: float) -> Evidence:
    """What is heard within `seconds` of the first word."""
    evidence = Evidence(watcher.robot)
    watcher.listen()
    first_by = time.monotonic() + _FIRST_WITHIN
    while evidence.empty and time.monotonic() < first_by:
        time.sleep(_LOOK_EVERY)
        watcher.pass_on(evidence)
    if evidence.empty:
        return evidence
    healths: list[Health] = []

    def on_reply(reply: zenoh.Reply) -> None:
        if reply.ok is not None:
            with suppress(msgspec.MsgspecError):  # of another version: what its samples say is enough
                healths.append(msgspec.msgpack.decode(bytes(reply.ok.payload), type=Health))

    watcher.session.get(health_key(watcher.robot), on_reply, timeout=seconds)
    time.sleep(seconds)
    watcher.pass_on(evidence)
    evidence.health = list(healths)
    evidence.now_ns = robot_now_ns()
    return evidence


def _show(diagnosis: Diagnosis, unreadable: list[str]) -> None:
    console = Page()
    table = Table.grid(padding=(0, 2, 0, 0))
    table.add_column(justify="right", no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True, style="dim")
    table.add_column(overflow="fold")
    for link in diagnosis.links:
        age = "" if link.age is None else f"{link.age * 1000.0:.0f} ms"
        table.add_row(link.name, Text(link.standing, style=_STYLES[link.standing]), age, Text(link.text))
    console.print(table)
    for complaint in unreadable:
        console.print(Text(f"unreadable: {complaint}", style="yellow"))
    style = "bold red" if diagnosis.stopped_by else "bold green"
    console.print(Text.assemble((f"{diagnosis.robot}: ", "bold"), (diagnosis.conclusion, style)))
