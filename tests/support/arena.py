"""A round room: from its middle every sensor hears the wall, wherever the robot looks."""

from __future__ import annotations

import math
from typing import Final

_RADIUS: Final = 4.0
_CORNERS: Final = 36
_POINTS: Final = [
    (_RADIUS * math.cos(math.tau * corner / _CORNERS), _RADIUS * math.sin(math.tau * corner / _CORNERS))
    for corner in range(_CORNERS)
]

ARENA: Final = f"""
name = "arena"
start = {{ x = 0.0, y = 0.0, yaw_deg = 0.0 }}
[[walls]]
name = "round"
closed = true
points = [{", ".join(f"[{x:.4f}, {y:.4f}]" for x, y in _POINTS)}]
"""
