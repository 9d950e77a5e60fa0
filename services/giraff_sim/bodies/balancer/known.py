"""What `giraff run` tells the services of a simulated robot that balances."""

from __future__ import annotations

from typing import Final

from giraff_core.robot import WIRING

KNOWN: Final = {
    **{f"GIRAFF_BASE_DRIVE__{name.upper()}": "false" for name in WIRING},
    "GIRAFF_GUARD_DECELERATION": "0.35",
}
"""Variables for the services: values that are measured on a real robot before it may drive, and known of this one.
It stops within v²/0.7 + 0.12 m. The `margin` of its robot file has the 0.12 m."""
