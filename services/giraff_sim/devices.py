"""Simulated devices that are no boards of ours: which of them a robot has."""

from importlib.util import find_spec

from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_node.config.robot_file import load
from giraff_scan.config import ScanConfig, scanner_of
from giraff_schemas.services import SCAN
from giraff_sim.hosts.cable import Device
from giraff_sim.world.world import World


def devices_of(robot: RobotConfig, world: World) -> dict[str, Device]:
    """Return the devices of a robot, by the service that reads each. Raises ValueError for one that cannot be made."""
    if not robot.of(LaserScanner):
        return {}
    if find_spec("numpy") is None:
        raise ValueError("the simulated laser scanner needs numpy: pip install numpy")
    from giraff_sim.world.ld19 import Ld19  # noqa: PLC0415

    scanner = scanner_of(load(SCAN.table, ScanConfig, port="simulated"), robot)
    return {SCAN.name: Ld19(scanner, world, f"{world.seed}/{SCAN.name}")}
