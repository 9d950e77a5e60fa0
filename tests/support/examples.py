"""Where the examples of `giraff_client` stand, the first one of its page, and a hall for them to drive in."""

from typing import Final

from giraff_sim.board import ROOT

EXAMPLES: Final = ROOT / "examples"
HALL: Final = """
name = "hall"
start = { x = 0.0, y = 0.0, yaw_deg = 4.0 }

[[walls]]
name = "room"
points = [[5.0, 0.85], [-3.0, 0.85], [-3.0, -4.0], [5.0, -4.0]]
closed = true
"""
"""The wall on the left is 0.6 m from the sensors of a robot that faces it."""


def first_of_the_page() -> str:
    """The first example of docs/client.md, as it is printed there."""
    return (ROOT / "docs" / "client.md").read_text().split("```python\n")[1].split("```")[0]
