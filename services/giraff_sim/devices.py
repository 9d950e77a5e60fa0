"""Simulated devices that are no boards of ours: which of them a robot has, and their serial ports."""

import os
import tty
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_node.config.robot_file import load
from giraff_scan.config import ScanConfig, scanner_of
from giraff_schemas.services import SCAN
from giraff_sim.hosts.cable import Device
from giraff_sim.world.world import World

_READ_BYTES: Final = 4096


def devices_of(robot: RobotConfig, world: World) -> dict[str, Device]:
    """Return the devices of a robot, by the service that reads each. Raises ValueError for one that cannot be made."""
    if not robot.of(LaserScanner):
        return {}
    if find_spec("numpy") is None:
        raise ValueError("the simulated laser scanner needs numpy: pip install numpy")
    from giraff_sim.world.ld19 import Ld19  # noqa: PLC0415

    scanner = scanner_of(load(SCAN.table, ScanConfig, port="simulated"), robot)
    return {SCAN.name: Ld19(scanner, world, f"{world.seed}/{SCAN.name}")}


class DevicePort:
    """The cable between a device and whoever opens `path`: a pseudo terminal behind it."""

    def __init__(self, device: Device, path: Path) -> None:
        self.path = path
        self._device = device
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._theirs))

    def carry(self, now_us: int) -> None:
        """Pass bytes on, both ways. What does not fit is lost, as on a wire."""
        if data := self._device.bytes_until(now_us):
            with suppress(BlockingIOError):
                os.write(self._ours, data)
        with suppress(BlockingIOError):
            self._device.receive(os.read(self._ours, _READ_BYTES))

    def close(self) -> None:
        """Pull the cable."""
        self.path.unlink(missing_ok=True)
        os.close(self._ours)
        os.close(self._theirs)
