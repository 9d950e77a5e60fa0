"""How fast one may go towards an obstacle: reaction at constant speed, then constant deceleration, then the run-on."""

import math


def stopping_distance(speed: float, reaction_time: float, deceleration: float, run_on: float = 0.0) -> float:
    """m that a robot at `speed` (m/s) still travels: v·t + v²/2a, and `run_on` m where it moves."""
    return speed * reaction_time + speed * speed / (2.0 * deceleration) + (run_on if speed > 0.0 else 0.0)


def fastest(room: float, reaction_time: float, deceleration: float, run_on: float = 0.0) -> float:
    """The speed (m/s) whose stopping distance is `room` (m); 0 where there is no room."""
    room -= run_on
    if room <= 0.0:
        return 0.0
    lag = deceleration * reaction_time
    # Not the root less the lag: of two numbers that are nearly the same, little that is true would be left.
    gain = 2.0 * deceleration * room
    root = lag + math.sqrt(lag * lag + gain)
    return gain / root if root > 0.0 else 0.0  # so little room that its gain is rounded to 0
