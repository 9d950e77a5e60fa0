"""The picture of docs/structure.md: packages in their layers, and which imports which, drawn from the sources."""

from __future__ import annotations

import tomllib
from html import escape
from typing import Final

import grimp

from tests.rules.repository import ROOT, contracts, packages

_BOX_HEIGHT, _ROW, _GAP, _MARGIN, _CHARACTER = 46, 86, 14, 16, 7.2
_LANE, _SIDE = 18, 64
_SERVICES: Final = "services"
"""One box for all of them: they stand beside each other and none imports another."""
_TITLES: Final = {
    "giraff_client": "a script of yours",
    "giraff_cli": "the giraff command",
    "giraff_sim": "world, boards, faults",
    _SERVICES: "one package each; none imports another",
    "giraff_keys": "certificates",
    "giraff_maps": "floor plans",
    "giraff_mcap": "recordings",
    "giraff_telemetry": "a robot in words, panels",
    "giraff_viewer": "rerun",
    "giraff_node": "config, network, process, boards",
    "giraff_core": "pure: freshness, lease, robot, parameters, kinematics, operator",
    "giraff_schemas": "messages, topics, services, wire",
    "giraff_health": "asks a process how it is",
}


def layers() -> list[list[str]]:
    """Packages by layer, the highest first, as the import contracts have them; services as one."""
    [contract] = [
        each
        for each in tomllib.loads(contracts())["tool"]["importlinter"]["contracts"]
        if each["type"] == "layers" and "containers" not in each
    ]
    rows = [row.split(" | ") for row in contract["layers"]]
    return [[_SERVICES] if "giraff_base" in row else row for row in rows]


def imports() -> set[tuple[str, str]]:
    """(importer, imported) of the boxes, without those that follow from others."""
    graph = grimp.build_graph(*packages(), cache_dir=None)
    named = {name for row in layers() for name in row}

    def box(module: str) -> str:
        package = module.partition(".")[0]
        return package if package in named else _SERVICES

    found = {
        (box(module), box(other))
        for module in graph.modules
        for other in graph.find_modules_directly_imported_by(module)
        if box(module) != box(other)
    }

    def reaches(start: str, end: str) -> bool:
        return any(a == start and (b == end or reaches(b, end)) for a, b in found)

    return {(a, b) for a, b in found if not any(x == a and y != b and reaches(y, b) for x, y in found)}


def draw() -> str:
    """As SVG."""
    rows = layers()
    texts = {name: (name, _TITLES[name]) for row in rows for name in row}
    sizes = {name: max(map(len, lines)) * _CHARACTER + 24 for name, lines in texts.items()}
    width = max(sum(sizes[name] for name in row) + _GAP * (len(row) - 1) for row in rows) + 2 * _SIDE
    places: dict[str, tuple[float, float]] = {}
    for number, row in enumerate(rows):
        room = (width - sum(sizes[name] for name in row)) / (len(row) + 1)
        x = room
        for name in row:
            places[name] = x, _MARGIN + number * _ROW
            x += sizes[name] + room
    height = _MARGIN * 2 + (len(rows) - 1) * _ROW + _BOX_HEIGHT
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}"',
        ' font-family="monospace" font-size="12">',
        '<defs><marker id="a" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">',
        '<path d="M0 0 8 4 0 8z" fill="#667"/></marker></defs>',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
    ]
    lanes = {-1: _MARGIN, 1: _MARGIN}  # those taken beside the boxes: one that skips a layer goes round
    for a, b in sorted(imports()):
        (ax, ay), (bx, by) = places[a], places[b]
        if by - ay <= _ROW:
            path = f"M{ax + sizes[a] / 2:.0f} {ay + _BOX_HEIGHT} L{bx + sizes[b] / 2:.0f} {by}"
        else:
            side = 1 if ax + sizes[a] / 2 >= width / 2 else -1
            lane = width - lanes[side] if side > 0 else lanes[side]
            lanes[side] += _LANE
            start, end = (ax + sizes[a], bx + sizes[b]) if side > 0 else (ax, bx)
            path = f"M{start:.0f} {ay + 32} H{lane:.0f} V{by + 14} H{end:.0f}"
        lines.append(f'<path d="{path}" fill="none" stroke="#667" marker-end="url(#a)"/>')
    for name, (x, y) in places.items():
        title, what = texts[name]
        lines += [
            f'<rect x="{x:.0f}" y="{y}" width="{sizes[name]:.0f}" height="{_BOX_HEIGHT}" rx="6"',
            ' fill="#f4f1e8" stroke="#a98"/>',
            f'<text x="{x + 12:.0f}" y="{y + 19}" font-weight="bold">{escape(title)}</text>',
            f'<text x="{x + 12:.0f}" y="{y + 36}" fill="#555">{escape(what)}</text>',
        ]
    return "\n".join([*lines, "</svg>", ""])


PICTURE: Final = ROOT / "docs" / "structure.svg"
