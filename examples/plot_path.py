"""Draw the path of the next seconds, whoever drives. Usage: python plot_path.py [SECONDS [FILE.svg]]"""

import sys
import time
from pathlib import Path

from giraff_client import Robot

seconds, file = (*sys.argv[1:], "10", "path.svg")[:2] if len(sys.argv) < 3 else sys.argv[1:3]
points = []
with Robot() as robot:
    until = time.monotonic() + float(seconds)
    while time.monotonic() < until:
        points.append((robot.odom().x, -robot.odom().y))  # an SVG's y points down
        time.sleep(0.1)
left, top = (min(point[axis] for point in points) - 0.3 for axis in (0, 1))
width, height = (max(point[axis] for point in points) + 0.3 - edge for axis, edge in ((0, left), (1, top)))
line = " ".join(f"{x:.3f},{y:.3f}" for x, y in points)
box = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left:.3f} {top:.3f} {width:.3f} {height:.3f}">'
Path(file).write_text(f'{box}<polyline points="{line}" fill="none" stroke="black" stroke-width="0.02"/></svg>\n')
