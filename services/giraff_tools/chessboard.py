"""The chessboard that a camera is calibrated by, and its drawing for a sheet of A4."""

from typing import Final

COLUMNS: Final = 9
ROWS: Final = 6
"""Inner corners, where four squares meet: one row fewer than squares."""
SQUARE: Final = 25.0
"""mm."""
A4: Final = (297.0, 210.0)
"""mm, long side first."""

_RULER: Final = 100  # mm
_TICK: Final = 10  # mm


def drawing() -> str:
    """Return the board as SVG, in true size."""
    width, height = A4
    left, top = (width - (COLUMNS + 1) * SQUARE) / 2.0, 9.0
    right, bottom = left + (COLUMNS + 1) * SQUARE, top + (ROWS + 1) * SQUARE
    squares = "".join(
        f"M{left + SQUARE * column:g} {top + SQUARE * row:g}h{SQUARE:g}v{SQUARE:g}h-{SQUARE:g}z"
        for row in range(ROWS + 1)
        for column in range(COLUMNS + 1)
        if (row + column) % 2 == 0
    )
    across, down = bottom + 9.0, right + 9.0
    ticks = range(0, _RULER + 1, _TICK)
    rulers = (
        f"M{left:g} {across:g}h{_RULER}M{down:g} {top:g}v{_RULER}"
        + "".join(f"M{left + tick:g} {across:g}v-3" for tick in ticks)
        + "".join(f"M{down:g} {top + tick:g}h-3" for tick in ticks)
    )
    words = (
        f"Print at 100 %, not fitted to the page. Both rulers must be {_RULER} mm long. "
        f"{COLUMNS} x {ROWS} inner corners, {SQUARE:g} mm."
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}">\n'
        f'<rect width="{width:g}" height="{height:g}" fill="#fff"/>\n'
        f'<path d="{squares}" fill="#000"/>\n'
        f'<path d="{rulers}" fill="none" stroke="#000" stroke-width="0.3"/>\n'
        f'<text x="{left:g}" y="{across + 6.0:g}" font-family="sans-serif" font-size="4">{words}</text>\n'
        "</svg>\n"
    )
