"""The picture of docs/structure.md: packages in their layers, and which imports which, drawn from the sources."""

import tomllib
from html import escape
from typing import Final, NamedTuple

import grimp

from tests.rules.repository import ROOT, contracts, packages

_BOX_HEIGHT, _ROW, _GAP, _MARGIN, _CHARACTER = 46, 86, 14, 16, 7.2
_LANE, _SIDE = 18, 64
_SERVICES: Final = "services"
"""One box for all of them: they stand beside each other and none imports another."""
_TITLES: Final = {
    "giraff_client": "a script of yours",
    "giraff_cli": "the giraff command",
    "giraff_setup": "measurements, fits, drawings",
    "giraff_sim": "world, boards, faults",
    "giraff_tools": "what commands share",
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


class Box(NamedTuple):
    """Place of a package in the picture."""

    x: float
    y: float
    width: float

    @property
    def middle(self) -> float:
        return self.x + self.width / 2

    def holds(self, x: float, y: float) -> bool:
        """Tell whether a point lies within, its edge left out."""
        return self.x < x < self.x + self.width and self.y < y < self.y + _BOX_HEIGHT


Arrow = list[tuple[float, float]]
"""Its corners, from the importer to the imported package."""


def placed() -> tuple[dict[str, Box], list[Arrow], float, float]:
    """Boxes by package, the arrows between them, and the picture's width and height."""
    rows = layers()
    sizes = {name: max(map(len, (name, _TITLES[name]))) * _CHARACTER + 24 for row in rows for name in row}
    width = max(sum(sizes[name] for name in row) + _GAP * (len(row) + 1) for row in rows) + 2 * _SIDE
    boxes: dict[str, Box] = {}
    for number, row in enumerate(rows):
        room = (width - 2 * _SIDE - sum(sizes[name] for name in row)) / (len(row) + 1)
        x = _SIDE + room
        for name in row:
            boxes[name] = Box(x, _MARGIN + number * _ROW, sizes[name])
            x += sizes[name] + room
    arrows: list[Arrow] = []
    lanes = {-1: 0, 1: 0}  # those taken beside the boxes: an arrow that skips a layer goes round, between the rows
    for a, b in sorted(imports()):
        above, below = boxes[a], boxes[b]
        start, end = (above.middle, above.y + _BOX_HEIGHT), (below.middle, below.y)
        if below.y - above.y <= _ROW:
            arrows.append([start, end])
            continue
        side = 1 if above.middle >= width / 2 else -1
        lane = _MARGIN + lanes[side] * _LANE
        out, back = start[1] + 6 + 4 * lanes[side], end[1] - 12 - 4 * lanes[side]
        lanes[side] += 1
        x = width - lane if side > 0 else lane
        arrows.append([start, (start[0], out), (x, out), (x, back), (end[0], back), end])
    return boxes, arrows, width, _MARGIN * 2 + (len(rows) - 1) * _ROW + _BOX_HEIGHT


def draw() -> str:
    """As SVG."""
    boxes, arrows, width, height = placed()
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}"',
        ' font-family="monospace" font-size="12">',
        '<defs><marker id="a" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">',
        '<path d="M0 0 8 4 0 8z" fill="#667"/></marker></defs>',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
    ]
    for arrow in arrows:
        path = "M" + " L".join(f"{x:.0f} {y:.0f}" for x, y in arrow)
        lines.append(f'<path d="{path}" fill="none" stroke="#667" marker-end="url(#a)"/>')
    for name, (x, y, size) in boxes.items():
        lines += [
            f'<rect x="{x:.0f}" y="{y}" width="{size:.0f}" height="{_BOX_HEIGHT}" rx="6"',
            ' fill="#f4f1e8" stroke="#a98"/>',
            f'<text x="{x + 12:.0f}" y="{y + 19}" font-weight="bold">{escape(name)}</text>',
            f'<text x="{x + 12:.0f}" y="{y + 36}" fill="#555">{escape(_TITLES[name])}</text>',
        ]
    return "\n".join([*lines, "</svg>", ""])


PICTURE: Final = ROOT / "docs" / "structure.svg"
