"""Why a picture is no measurement."""

from __future__ import annotations

from typing import Final

from giraff_schemas.trouble import Trouble

FIRST: Final = Trouble("the first picture", "")
NO_FLOOR: Final = Trouble(
    "the camera sees no floor", "mount it to look down, and let giraff calibrate camera write its pitch and height"
)
DARK: Final = Trouble("too dark", "give the floor ahead more light")
OVEREXPOSED: Final = Trouble("over-exposed", "take a lamp or the sun out of the camera's view, or let it expose less")
COVERED: Final = Trouble("covered", "uncover and wipe the lens")
FEATURELESS: Final = Trouble("nothing to follow on the floor", "a plain floor shows no motion: go by the wheels")
FEW: Final = Trouble("too few corners could be followed", "the floor is plain, or motion too fast for the light")
BLURRED: Final = Trouble("blurred", "give more light, that the exposure is shorter, or drive slower")
LOST: Final = Trouble("the picture has changed too much", "look whether pictures are missing, or lamps switch")
MOVING: Final = Trouble("something moves, or is no floor", "wait until it has passed")
BUNCHED: Final = Trouble("corners on one spot only", "the rest of the floor is plain or covered")
UNSURE: Final = Trouble("the motion is not sure enough", "the floor is plain, or its pattern repeats")
DISAGREE: Final = Trouble(
    "picture and wheels disagree",
    "one of the two is wrong: look at the lens, at what moves before it, and whether wheels slip",
)
