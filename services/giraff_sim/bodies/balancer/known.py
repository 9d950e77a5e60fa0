"""What `giraff run` tells the services of a simulated robot that balances."""

from __future__ import annotations

from typing import Final

from giraff_core.robot import WIRING

KNOWN: Final = {f"GIRAFF_BASE_DRIVE__{name.upper()}": "false" for name in WIRING}
"""Variables for the services: values that are found out on a real robot before it may drive, and known of this one."""
