"""`giraff node list` and `info`: the services of a robot, where they run and how they are."""

from collections.abc import Iterator, Sequence
from typing import Final

import msgspec

from giraff_schemas.health import Health
from giraff_schemas.text import meant
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor, RobotGraph, names_of
from giraff_tools.terminal.page import print_json, print_table
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import duration

_WELL: Final = 0
_ILL: Final = 1
_SILENT: Final = "does not answer: it hangs, is of another version, or its answers may not come here"


class NodeRow(msgspec.Struct, frozen=True, kw_only=True):
    """A process that is on the network."""

    service: str
    instance: str
    health: Health | None
    """None: it does not answer."""

    @property
    def well(self) -> bool:
        return self.health is not None and self.health.ok


def list_nodes(robot: str | None, connect: Sequence[str], *, as_json: bool) -> int:
    """Print the services of a robot; the exit code."""

    def report(robot_graph: RobotGraph) -> int:
        rows = rows_of(robot_graph)
        if as_json:
            print_json(rows)
        else:
            _show_rows(rows)
        return _WELL if all(row.well for row in rows) else _ILL

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, lambda met: report(GraphMonitor(met).collect_health(stopping)))


def info(service: str, robot: str | None, connect: Sequence[str], *, as_json: bool) -> int:
    """Print all that one service tells of itself; the exit code."""

    def act(connection: RobotConnection) -> int:
        robot_graph = GraphMonitor(connection).collect_health(stopping)
        rows = [row for row in rows_of(robot_graph) if service in (row.service, row.instance)]
        if not rows:
            there = [*dict.fromkeys(maker.service for maker in robot_graph.services)]
            return print_error(
                f"{connection.robot} has no service {service!r} on the network; {meant(service, there)}"
                f"there are: {', '.join(there) or 'none'}"
            )
        if as_json:
            print_json(rows)
        else:
            for row in rows:
                _show(row, robot_graph)
        return _WELL if all(row.well for row in rows) else _ILL

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def rows_of(robot_graph: RobotGraph) -> list[NodeRow]:
    """Every process that is there."""
    return [
        NodeRow(service=maker.service, instance=maker.instance, health=robot_graph.healths.get(maker.instance))
        for maker in robot_graph.services
    ]


def _show_rows(rows: Sequence[NodeRow]) -> None:
    print_table(
        ("service", "instance", "host", ">pid", ">up", "state"),
        (
            (row.service, row.instance, "?", "?", "?", _SILENT)
            if row.health is None
            else (
                row.service,
                row.instance,
                row.health.host,
                str(row.health.pid),
                duration(row.health.uptime),
                "; ".join(map(str, (*row.health.faults, *row.health.notices))) or "well",
            )
            for row in rows
        ),
    )


def _show(row: NodeRow, robot_graph: RobotGraph) -> None:
    print_table(("", ""), _lines(row, robot_graph))


def _lines(row: NodeRow, robot_graph: RobotGraph) -> Iterator[tuple[str, str]]:
    health = row.health
    yield "service", row.service
    yield "instance", row.instance
    if health is None:
        yield "state", _SILENT
        return
    yield "host", f"{health.host}, pid {health.pid}, up {duration(health.uptime)}"
    yield "takes", f"{health.cpu_time:.1f} s of processor time, {health.rss_bytes / 1e6:.0f} MB of memory"
    yield "state", "well" if health.ok else "not well"
    yield from (("fault", str(each)) for each in health.faults)
    yield from (("notice", str(each)) for each in health.notices)
    for key in health.publishes:
        yield "publishes", f"{key} -> {names_of(robot_graph.subscribers(key)) or 'nobody that says so'}"
    for pattern in health.subscribes:
        yield "listens to", f"{pattern} <- {names_of(robot_graph.publishers_of(pattern)) or 'nobody'}"
    yield from (("answers", key) for key in health.answers)
