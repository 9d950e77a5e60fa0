"""giraff_vision: the process."""

import sys
from typing import Final

from giraff_node import Node
from giraff_node.process.libraries import missing_library
from giraff_schemas.services import VISION
from giraff_vision.config import VisionConfig

_REFUSED: Final = 2


def main() -> None:
    if why := missing_library(VISION):
        print(f"giraff_vision: {why}", file=sys.stderr)
        sys.exit(_REFUSED)
    from giraff_vision.service import Vision  # noqa: PLC0415  its libraries may be missing

    with Node("vision", VisionConfig) as node:
        try:
            vision = Vision(node, node.config, node.robot)
        except ValueError as error:
            node.log.error("%s", error)
            sys.exit(_REFUSED)
        node.run(vision)
