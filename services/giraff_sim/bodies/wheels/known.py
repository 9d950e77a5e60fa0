"""What `giraff run` tells the services of a simulated robot on two wheels."""

from __future__ import annotations

from typing import Final

from giraff_core.robot import WIRING

KNOWN: Final = {
    **{f"GIRAFF_BASE_DRIVE__{name.upper()}": "false" for name in WIRING},
    "GIRAFF_BASE_DRIVE__WHEEL_CONTROL": "speed",
    "GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT": "0.03",
    "GIRAFF_GUARD_DECELERATION": "1.5",
}
"""Variables for the services: values that are measured on a real robot before it may drive, and known of this one.
Its plant brakes at about 2.9 m/s²."""
