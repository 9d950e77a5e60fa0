"""Why a picture is no measurement."""

import math
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_schemas.trouble import Trouble

FIRST: Final = Trouble("it is the first picture, or the first of this size", "wait for the next one")
NO_FLOOR: Final = Trouble(
    "no floor is in view", "turn the camera down, and measure how it stands", "run", "giraff calibrate camera"
)
DARK: Final = Trouble("too dark", "give the floor ahead more light")
OVEREXPOSED: Final = Trouble("over-exposed", "take a lamp or the sun out of the camera's view, or let it expose less")
COVERED: Final = Trouble("covered", "uncover the lens, and wipe it")
FEATURELESS: Final = Trouble("nothing to follow on the floor", "go by the wheels: a plain floor shows no motion")
FEW: Final = Trouble("too few corners could be followed", "give more light, drive slower, or go by the wheels")
BLURRED: Final = Trouble("blurred", "give more light, or drive slower")
LOST: Final = Trouble("the picture has changed too much", "look whether pictures are missing, or lamps switch")
MOVING: Final = Trouble("something moves, or is no floor", "wait until it has passed")
BUNCHED: Final = Trouble("corners on one spot only", "drive on: the rest of the floor is plain or covered")
UNSURE: Final = Trouble("the motion is not sure enough", "go by the wheels: the floor is plain, or its pattern repeats")
_LOOK: Final = "one of the two is wrong: look at the lens, at what moves before it, and whether wheels slip"
DISAGREE: Final = Trouble("picture and wheels disagree", _LOOK)
DOUBTED: Final = Trouble("picture and wheels disagreed, and have not agreed over 5 cm since then", _LOOK)


def disagreement(seen: Pose, wheels: Pose) -> Trouble:
    """Return the disagreement with both motions; neither is called wrong."""
    texts = (f"x {each.x:z.2f} m, y {each.y:z.2f} m, {math.degrees(each.yaw):z.0f}°" for each in (seen, wheels))
    return Trouble("picture and wheels disagree: the picture saw {}, the wheels {}".format(*texts), _LOOK)
