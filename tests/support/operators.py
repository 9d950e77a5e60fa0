"""What a hand's operator says for it."""

from giraff_core.operator import Hand
from giraff_schemas.messages import DriveCommand


def said(hand: Hand, now: float) -> DriveCommand:
    """The command that a service would give now."""
    asked = hand.poll(now)
    assert asked is not None
    return hand.operator.say(asked)
