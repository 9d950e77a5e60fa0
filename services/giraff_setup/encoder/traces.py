"""Draw two channels over a few pairs, in characters and as SVG. Pure."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

from giraff_setup.encoder.quadrature import Figures
from giraff_setup.encoder.transitions import CHANNELS, Run, levels_between
from giraff_tools.terminal.dots import ACROSS, Dots

_PAIRS: Final = 6.0
_COLUMNS: Final = 72
_HIGH, _LOW = 1, 6  # dots of the two lines of a channel

_WIDTH, _HEIGHT = 760.0, 190.0  # of a wheel's drawing
_LEFT, _RIGHT = 40.0, 728.0  # of its traces
_AXIS: Final = 150.0
_STEPS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)
"""ms from one figure on the axis to the next."""
_MOST_FIGURES: Final = 12
_COLOURS: Final = ("#0b62a8", "#b3480b")


class Trace(NamedTuple):
    """A few pairs of one encoder."""

    run: Run
    begin: float
    """ms."""
    end: float

    @classmethod
    def of(cls, figures: Figures) -> "Trace | None":
        """Return the worst place. None: there is nothing to see."""
        if figures.worst is None or not figures.period_ms:
            return None
        run, at = figures.worst
        half = _PAIRS / 2.0 * figures.period_ms
        begin = max(0.0, at - half)
        return cls(run, begin, begin + 2.0 * half)

    def steps(self, channel: int, scale: float) -> Iterator[tuple[float, float, bool]]:
        """From where to where on a drawing of this width the channel has which level."""
        per_ms = scale / (self.end - self.begin)
        steps = [*levels_between(self.run, channel, self.begin, self.end), (self.end, False)]
        for (begin, level), (end, _) in pairwise(steps):
            yield (begin - self.begin) * per_ms, (end - self.begin) * per_ms, level


def traces(trace: Trace, *, dots: bool) -> Iterator[str]:
    """Draw it in lines of text."""
    for channel, name in enumerate(CHANNELS):
        drawing = Dots()
        rows = list[int]()
        for begin, end, level in trace.steps(channel, _COLUMNS * ACROSS - 1):
            row = _HIGH if level else _LOW
            for down in range(_HIGH, _LOW + 1) if rows and rows[-1] != row else ():
                drawing.set(round(begin), down)
            for across in range(round(begin), round(end) + 1):
                drawing.set(across, row)
            rows.append(row)
        for line, label in enumerate((name, "")):
            signs = (drawing.sign(line, column, dots=dots) for column in range(_COLUMNS))
            yield f"  {label:1} {''.join(signs).rstrip()}".rstrip()
    length = f"{trace.end - trace.begin:.3g} ms"
    yield f"    0{length:>{_COLUMNS - 1}}"


def drawing(wheels: Sequence[tuple[str, Trace]]) -> str:
    """Return an SVG of all wheels, each below its caption."""
    height = _HEIGHT * len(wheels)
    parts = "".join(
        f'<g transform="translate(0 {_HEIGHT * number:g})">\n{_wheel(caption, trace)}</g>\n'
        for number, (caption, trace) in enumerate(wheels)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH:g}" height="{height:g}" '
        f'viewBox="0 0 {_WIDTH:g} {height:g}" font-family="sans-serif" font-size="13">\n'
        f'<rect width="{_WIDTH:g}" height="{height:g}" fill="#fff"/>\n{parts}</svg>\n'
    )


def _wheel(caption: str, trace: Trace) -> str:
    lines = [f'<text x="12" y="26">{caption}</text>\n']
    for channel, name in enumerate(CHANNELS):
        middle = 66.0 + 52.0 * channel
        path = ""
        for begin, end, level in trace.steps(channel, _RIGHT - _LEFT):
            y = middle - 16.0 if level else middle + 16.0
            path += f"{'L' if path else 'M'}{_LEFT + begin:.2f} {y:g}H{_LEFT + end:.2f}"
        lines.append(f'<text x="12" y="{middle + 5.0:g}" fill="{_COLOURS[channel]}">{name}</text>\n')
        lines.append(f'<path d="{path}" fill="none" stroke="{_COLOURS[channel]}" stroke-width="2"/>\n')
    span = trace.end - trace.begin
    step = next((step for step in _STEPS if span / step <= _MOST_FIGURES), _STEPS[-1])
    lines.append(f'<path d="M{_LEFT:g} {_AXIS:g}H{_RIGHT:g}" stroke="#000"/>\n')
    for number in range(int(span / step) + 1):
        x = _LEFT + number * step / span * (_RIGHT - _LEFT)
        lines.append(f'<path d="M{x:.2f} 46V{_AXIS + 5.0:g}" stroke="#000" stroke-opacity="0.2"/>\n')
        lines.append(f'<text x="{x:.2f}" y="{_AXIS + 20.0:g}" text-anchor="middle">{number * step:g}</text>\n')
    lines.append(f'<text x="{_RIGHT + 2.0:g}" y="{_AXIS + 5.0:g}">ms</text>\n')
    return "".join(lines)
