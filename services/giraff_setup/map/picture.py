"""A floor plan as SVG: its walls on a grid with metres along two sides."""

from __future__ import annotations

import math
from collections.abc import Iterator
from html import escape
from typing import Final

from giraff_maps.floor_plan import FloorPlan

_SIDE: Final = 900.0  # px of the longer side
_MARGIN, _TOP = 48.0, 64.0  # px
_MOST_LINES: Final = 25  # of the grid along the longer side
_STEPS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
"""m between lines of the grid."""


def picture(plan: FloorPlan, title: str) -> str:
    """Metres of the plan's own frame are written at the grid."""
    step = _step(plan)
    left, bottom, right, top = plan.bounds
    left, bottom = math.floor(left / step) * step, math.floor(bottom / step) * step
    right, top = math.ceil(right / step) * step, math.ceil(top / step) * step
    per_metre = _SIDE / max(right - left, top - bottom)
    width, height = (right - left) * per_metre, (top - bottom) * per_metre

    def across(x: float) -> float:
        return _MARGIN + (x - left) * per_metre

    def down(y: float) -> float:
        return _TOP + (top - y) * per_metre

    page = max(width + 2 * _MARGIN, 420.0), height + _TOP + _MARGIN
    size = f'viewBox="0 0 {page[0]:.0f} {page[1]:.0f}" width="{page[0]:.0f}" height="{page[1]:.0f}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">',
        f'<rect width="{page[0]:.0f}" height="{page[1]:.0f}" fill="#fff"/>',
        f'<text x="{_MARGIN:.0f}" y="32" font-size="16" fill="#223">{escape(title)}</text>',
    ]
    for x in _marks(left, right, step):
        lines.append(f'<path d="M{across(x):.1f} {down(bottom):.1f} V{down(top):.1f}" stroke="#e4e4ec"/>')
        lines.append(_label(f"{x:g}", across(x), down(bottom) + 18.0, "middle"))
    for y in _marks(bottom, top, step):
        lines.append(f'<path d="M{across(left):.1f} {down(y):.1f} H{across(right):.1f}" stroke="#e4e4ec"/>')
        lines.append(_label(f"{y:g}", _MARGIN - 8.0, down(y) + 4.0, "end"))
    lines.append(_label("m", _MARGIN - 8.0, _TOP - 12.0, "end"))
    walls = " ".join(
        f"M{across(x):.1f} {down(y):.1f} L{across(end_x):.1f} {down(end_y):.1f}" for x, y, end_x, end_y in plan.walls
    )
    lines.append(f'<path d="{walls}" fill="none" stroke="#223" stroke-width="2" stroke-linecap="round"/>')
    return "\n".join([*lines, "</svg>", ""])


def _step(plan: FloorPlan) -> float:
    left, bottom, right, top = plan.bounds
    side = max(right - left, top - bottom)
    return next((step for step in _STEPS if side / step <= _MOST_LINES), _STEPS[-1])


def _marks(begin: float, end: float, step: float) -> Iterator[float]:
    for number in range(round((end - begin) / step) + 1):
        yield round(begin + number * step, 6) + 0.0  # never -0


def _label(text: str, x: float, y: float, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="#667" text-anchor="{anchor}">{text}</text>'
