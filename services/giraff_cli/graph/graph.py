"""`giraff graph`: services as nodes, topics as edges, the way rxgraph drew them."""

from collections.abc import Sequence

import msgspec

from giraff_schemas.text import printable_lines
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.robot_graph import GraphMonitor, NodeId, RobotGraph
from giraff_tools.terminal.page import print_json, print_table
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import quoted


class Edge(msgspec.Struct, frozen=True, order=True):
    """What one process says and another hears."""

    source: str
    """Name of a node."""
    key: str
    target: str
    """Name of a node; empty: nobody says that he listens."""


class Graph(msgspec.Struct, frozen=True, kw_only=True):
    """Who is there and who hears whom."""

    robot: str
    nodes: dict[str, NodeId]
    """By name: the service, and its instance where several are there."""
    edges: list[Edge]


def graph(robot: str | None, connect: Sequence[str], seconds: float, *, as_dot: bool, as_json: bool) -> int:
    """Draw the services of a robot; the exit code."""

    def report(robot_graph: RobotGraph) -> int:
        drawn = graph_of(robot_graph)
        if as_json:
            print_json(drawn)
        elif as_dot:
            print(printable_lines(dot(drawn)))
        else:
            _show(drawn)
        return 0

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, lambda met: report(GraphMonitor.counting(met).run(seconds, stopping)))


def graph_of(robot_graph: RobotGraph) -> Graph:
    """Of what is known."""
    makers = {*robot_graph.services, *(maker for key in robot_graph.keys for maker in robot_graph.publishers(key))}
    names = [maker.name for maker in makers]
    nodes = {
        (maker.name if names.count(maker.name) == 1 else f"{maker.name} {maker.instance}"): maker
        for maker in sorted(makers)
    }
    name_of = {maker: name for name, maker in nodes.items()}
    edges = [
        Edge(name_of[source], key, target)
        for key in robot_graph.keys
        for source in robot_graph.publishers(key)
        for target in [name_of[maker] for maker in robot_graph.subscribers(key)] or [""]
    ]
    return Graph(robot=robot_graph.robot, nodes=nodes, edges=edges)


def dot(drawn: Graph) -> str:
    """For Graphviz: `giraff graph --dot | dot -Tsvg`."""
    lines = [f"digraph {quoted(drawn.robot)} {{", "  rankdir=LR;", "  node [shape=ellipse];"]
    lines += [f"  {quoted(name)};" for name in drawn.nodes]
    unheard = sorted({edge.key for edge in drawn.edges if not edge.target})
    lines += [f"  {_box(key)} [label={quoted(key)}, shape=box, style=dashed];" for key in unheard]
    for edge in drawn.edges:
        if edge.target:
            lines.append(f"  {quoted(edge.source)} -> {quoted(edge.target)} [label={quoted(edge.key)}];")
        else:
            lines.append(f"  {quoted(edge.source)} -> {_box(edge.key)} [style=dashed];")
    return "\n".join([*lines, "}"])


def _box(key: str) -> str:
    """The node of a key, apart from those of services: base says `base`. No service's name has a slash."""
    return quoted(f"/{key}")


def _show(drawn: Graph) -> None:
    rows = []
    for name in drawn.nodes:
        spoken = list(dict.fromkeys(edge.key for edge in drawn.edges if edge.source == name))
        for number, key in enumerate(spoken or [""]):
            heard = ", ".join(edge.target for edge in drawn.edges if (edge.source, edge.key) == (name, key))
            rows.append((name if number == 0 else "", key, f"-> {heard or 'nobody that says so'}" if key else ""))
    print_table(("service", "says", "heard by"), rows)
