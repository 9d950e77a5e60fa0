"""What `giraff run` tells the services of a simulated robot on two wheels."""

from __future__ import annotations

from typing import Final

KNOWN: Final = {
    "GIRAFF_BASE_DRIVE__SWAP_MOTORS": "false",
    "GIRAFF_BASE_DRIVE__SWAP_ENCODERS": "false",
    "GIRAFF_BASE_DRIVE__INVERT_LEFT_MOTOR": "false",
    "GIRAFF_BASE_DRIVE__INVERT_RIGHT_MOTOR": "false",
    "GIRAFF_BASE_DRIVE__INVERT_LEFT_ENCODER": "false",
    "GIRAFF_BASE_DRIVE__INVERT_RIGHT_ENCODER": "false",
    "GIRAFF_BASE_DRIVE__WHEEL_CONTROL": "speed",
    "GIRAFF_GUARD_DECELERATION": "1.5",
}
"""What is measured on a real robot before it may drive, and known of the simulated one: for its services'
environment. Its plant brakes at about 2.9 m/s²."""
