"""Bars, drawn from the results: each picture by its file's name. Legible on light and on dark pages."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Final

from bench.figures import BARE, MEASURED, Figures

_WIDTH, _LEFT, _RIGHT, _TOP, _BAR, _GAP = 760, 190, 70, 62, 15, 14
_STYLE: Final = """text { font: 13px sans-serif; fill: #6e7781 } .title { font-weight: bold; font-size: 15px }
.c0 { fill: #8c959f } .c1 { fill: #bf8700 } .c2 { fill: #2f81f7 }"""

Group = tuple[str, Sequence[float]]
"""Name of a group of bars, and a value for each series."""


def pictures(figures: Figures) -> dict[str, str]:
    """Return the SVG of each file."""
    stacks = ("raw", "floor", "node")
    ways = {
        "one way, 100 Hz": "one way 100 Hz p50",
        "one way, 1 kHz": "one way 1000 Hz p50",
        "round trip": "round trip p50",
        "publisher's processor": "publisher 1000 Hz",
        "subscriber's processor": "subscriber 1000 Hz",
    }
    soon = [(title, [figures.median(figure, stack) for stack in stacks]) for title, figure in ways.items()]
    cost = [
        (service, [figures.median("processor", BARE + service), figures.median("processor", service)])
        for service in MEASURED
    ]
    return {
        "performance-samples.svg": bars(
            "A sample of odometry: latency (p50) and processor time (at 1 kHz), µs",
            {"bare Zenoh": 0, "bare Zenoh and msgspec": 1, "a Node": 2},
            soon,
        ),
        "performance-services.svg": bars(
            "% of a core while the robot drives", {"bare Zenoh with the same traffic": 0, "the service": 2}, cost
        ),
    }


def bars(title: str, series: Mapping[str, int], groups: Sequence[Group]) -> str:
    """`series`: each one's name and the number of its colour."""
    longest = max(value for _, values in groups for value in values)
    scale = (_WIDTH - _LEFT - _RIGHT) / longest
    height = _TOP + len(groups) * (len(series) * _BAR + _GAP)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" width="{_WIDTH}" role="img">',
        f"<title>{escape(title)}</title>",
        f"<style>{_STYLE}</style>",
        f'<text class="title" x="8" y="20">{escape(title)}</text>',
    ]
    x = 8
    for name, colour in series.items():
        lines.append(f'<rect class="c{colour}" x="{x}" y="32" width="12" height="12"/>')
        lines.append(f'<text x="{x + 18}" y="43">{escape(name)}</text>')
        x += 40 + 7 * len(name)
    y = _TOP
    for name, values in groups:
        lines.append(f'<text x="8" y="{y + len(values) * _BAR / 2 + 4:g}">{escape(name)}</text>')
        for value, colour in zip(values, series.values(), strict=True):
            end = _LEFT + value * scale
            lines.append(
                f'<rect class="c{colour}" x="{_LEFT}" y="{y}" width="{value * scale:.1f}" height="{_BAR - 2}"/>'
            )
            lines.append(f'<text x="{end + 6:.1f}" y="{y + _BAR - 4}">{value:.3g}</text>')
            y += _BAR
        y += _GAP
    return "\n".join([*lines, "</svg>", ""])
