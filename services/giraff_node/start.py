"""python -m giraff_node NAME: the process of a service, by its row of the table.

Services stand above this package: what one is made of is imported by name.
"""

import gc
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import suggestion
from giraff_node.node import Node
from giraff_node.process.c_library import limit_heaps
from giraff_schemas.services import SERVICES, Service

limit_heaps()

_STARTED = {service.name: service for service in SERVICES if service.entry}


def main(words: Sequence[str]) -> int:
    """Run the service that the words name; the exit code."""
    match words:
        case [name] if name in _STARTED:
            return start(name)
        case [name]:
            problem = f"there is no service {name!r}{suggestion(name, [*_STARTED])}"
        case _:
            problem = f"give the name of one service{suggestion('', [*_STARTED])}"
    print(f"giraff_node: {problem}", file=sys.stderr)
    return 2


def start(name: str) -> int:
    """Run the service of this name until its end; the exit code."""
    service = _STARTED[name]
    if service.entry == "main":
        return _module(service, "main").main() or 0
    config = getattr(_module(service, "config"), f"{name.capitalize()}Config")
    with Node(name, config) as node:
        try:
            made = build(service, node, node.config, node.robot)
        except ValueError as error:  # the robot file asks for what this service does not have
            node.log.error("%s", error)
            sys.exit(2)
        gc.freeze()  # what stays is not looked through again, which takes some ms and would hold up a turn
        node.run(made, prompt=True)
    return 0


def build(service: Service, io: IO, config: Any, robot: RobotConfig, *more: Any) -> Any:
    """What a `Node` turns. `more`: what a service with a `main` of its own gives to it. Raises ValueError."""
    name = service.name.capitalize()
    if service.entry == "hand":
        from giraff_core.operator import OperatorService  # noqa: PLC0415  the robot's own services need none of it

        return OperatorService(io, getattr(_module(service, "hand"), name)(config, robot, io.instance))
    return getattr(_module(service, "service"), name)(io, config, robot, *more)


def _module(service: Service, part: str) -> Any:
    return import_module(f"{service.package}.{part}")
