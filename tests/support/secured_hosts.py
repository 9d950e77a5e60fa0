"""A robot on a secured network, and its hosts: a certificate for each, and what each may do."""

import datetime as dt
from pathlib import Path
from typing import Final

from giraff_core.access import AccessConfig
from giraff_setup.keys.manage import make_authority, make_bundle

ROBOT: Final = "sim-secured"
HOSTS: Final = ("robot", "laptop", "desk", "unnamed")
ACCESS: Final = AccessConfig(robot=("robot",), operators={"laptop": ("joystick", "camera")}, viewers=("desk",))


def authority(folder: Path) -> Path:
    """A folder of keys with a bundle for each host."""
    made, now = folder / "keys", dt.datetime.now(dt.UTC)
    make_authority(made, now)
    for host in HOSTS:
        make_bundle(made, host, ["192.0.2.1"], days=60, renew=False, moment=now)
    return made
