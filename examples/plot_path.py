"""Draw the path of the next seconds, whoever drives. Usage: python plot_path.py [SECONDS [FILE.svg]]"""

import sys
import time
from pathlib import Path

from giraff_client import Robot

seconds, file = (*sys.argv[1:], "10", "path.svg")[:2] if len(sys.argv) < 3 else sys.argv[1:3]
paths: dict[int, list[tuple[float, float]]] = {}  # by jump of odometry, over which no robot goes
with Robot() as robot:
    until = time.monotonic() + float(seconds)
    while time.monotonic() < until:
        paths.setdefault((at := robot.odom()).jumps, []).append((at.x, -at.y))  # an SVG's y points down
        time.sleep(0.1)
left, top = (min(point[axis] for path in paths.values() for point in path) - 0.3 for axis in (0, 1))
right, bottom = (max(point[axis] for path in paths.values() for point in path) + 0.3 for axis in (0, 1))
lines = " M".join(" ".join(f"{x:.3f},{y:.3f}" for x, y in path) for path in paths.values())
box = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left:.3f} {top:.3f} {right - left:.3f} {bottom - top:.3f}">'
Path(file).write_bytes(f'{box}<path d="M{lines}" fill="none" stroke="black" stroke-width="0.02"/></svg>\n'.encode())
