"""The colours of everything, so that a thing has the same one wherever it is drawn."""

from typing import Final

from giraff_schemas.localization import LocalizationState
from giraff_viewer.evidence import EvidenceState

Colour = tuple[int, int, int]

WHITE: Final[Colour] = (230, 230, 230)
GREY: Final[Colour] = (120, 120, 120)
GREEN: Final[Colour] = (40, 190, 80)
AMBER: Final[Colour] = (255, 176, 0)
OLIVE: Final[Colour] = (140, 140, 40)
RED: Final[Colour] = (240, 50, 50)
VIOLET: Final[Colour] = (170, 90, 230)
BLUE: Final[Colour] = (70, 140, 255)
CYAN: Final[Colour] = (0, 200, 220)
PINK: Final[Colour] = (255, 110, 180)

ROBOT: Final = WHITE
PATH: Final = BLUE
VISUAL: Final[Colour] = (255, 225, 80)
BLIND: Final[Colour] = (150, 130, 50)
"""Where the path of the camera is the wheels' word."""
ELLIPSE: Final = CYAN
TRUTH: Final = PINK
TILT: Final = PINK
LINES: Final[Colour] = (60, 60, 66)
WALLS: Final[Colour] = (175, 165, 150)
ROOM: Final[Colour] = (150, 105, 130)
"""The room of a simulated robot, as the truth is pink: the robot does not know it."""
ECHOES: Final[Colour] = (205, 135, 60)
PARTICLES: Final[Colour] = (90, 130, 190)
CANDIDATES: Final[Colour] = (255, 140, 60)
NAMED: Final[Colour] = (80, 220, 190)
"""Places that have a name."""
NO_GO: Final = RED
ROUTE: Final[Colour] = (200, 120, 255)

EVIDENCE: Final[dict[EvidenceState, Colour]] = {
    "free": GREEN,
    "near": AMBER,
    "blocked": RED,
    "doubted": OLIVE,
    "fault": VIOLET,
}
PLACES: Final[dict[LocalizationState, Colour]] = {
    "localized": (120, 255, 60),
    "told": (255, 255, 160),
    "ambiguous": (255, 215, 60),
    "lost": (255, 90, 90),
    "no_map": GREY,
}
LEVELS: Final[dict[str, Colour]] = {"INFO": WHITE, "WARN": AMBER, "ERROR": RED}
