"""`giraff graph --dot`: services and keys are boxes of their own, also where they are called the same."""

import re

from giraff_cli.graph.graph import Edge, Graph, dot
from giraff_tools.network.robot_graph import NodeId

DRAWN = Graph(
    robot="anne",
    nodes={name: NodeId(name, "1") for name in ("base", "guard")},
    edges=[
        Edge("base", "base", ""),
        Edge("base", "tick", "guard"),
        Edge("guard", "guard", ""),
        Edge("guard", "base", ""),
    ],
)


def test_a_service_and_a_key_of_one_name_are_two_boxes() -> None:
    """`base` publishes on `base`, and `guard` on `guard`."""
    lines = dot(DRAWN).splitlines()
    boxes = {match[1]: match[2] or "" for line in lines if (match := re.fullmatch(r'  "([^"]+)"(?: \[(.*)\])?;', line))}
    assert len(boxes) == 4
    keys = {id_: looks for id_, looks in boxes.items() if "shape=box" in looks}
    assert keys.keys().isdisjoint(DRAWN.nodes)
    label = {id_: re.findall(r'label="([^"]+)"', looks)[0] for id_, looks in keys.items()}
    assert sorted(label.values()) == ["base", "guard"]
    dashed = [re.findall(r'"([^"]+)"', line) for line in lines if "->" in line and "style=dashed" in line]
    assert sorted((source, label[target]) for source, target in dashed) == [
        ("base", "base"),
        ("guard", "base"),
        ("guard", "guard"),
    ]
    assert '  "base" -> "guard" [label="tick"];' in lines
