"""giraff_camera: the process."""

import sys
from contextlib import closing
from typing import Final

from giraff_camera.config import CameraConfig, camera_of
from giraff_node import Node
from giraff_node.process.libraries import missing_library
from giraff_schemas.services import CAMERA

_REFUSED: Final = 2


def main() -> None:
    if why := missing_library(CAMERA):
        print(f"giraff_camera: {why}", file=sys.stderr)
        sys.exit(_REFUSED)
    from giraff_camera.device.capture import Capture  # noqa: PLC0415  its libraries may be missing
    from giraff_camera.device.opening import open_camera  # noqa: PLC0415
    from giraff_camera.service import Camera  # noqa: PLC0415

    with Node("camera", CameraConfig) as node:
        config = node.config
        try:
            _, model = camera_of(config, node.robot)
        except ValueError as error:
            node.log.error("%s", error)
            sys.exit(_REFUSED)
        capture = Capture(lambda: open_camera(config.device, model.width, model.height, config.rate))
        with closing(capture):
            node.run(Camera(node, config, node.robot, capture, node.log.info))
