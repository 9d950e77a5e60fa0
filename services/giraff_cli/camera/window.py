"""The window of `giraff camera view`."""

import math
import os
import sys
import time
from typing import Any, Final

from giraff_core.picture.receiver import PictureReceiver
from giraff_node import robot_now_ns
from giraff_node.network.tcp_options import set_tcp_options
from giraff_schemas.messages import Sample, Tick
from giraff_schemas.topics import CAMERA, TICK, Topic
from giraff_tools.network.command import print_error
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.ports import free_port
from giraff_tools.terminal.signals import StopSignal
from giraff_viewer.scene import stock
from giraff_viewer.show import Show, require_screen
from giraff_viewer.window import ViewerError, Window

_TURN: Final = 0.03  # s
_MEMORY: Final = "200MB"
"""What the window keeps: some minutes, to look back."""
_DONE: Final = 0
_FAILED: Final = 1


def show(
    connection: RobotConnection,
    pictures: PictureReceiver,
    camera: str,
    seconds: float | None,
    stopping: StopSignal,
) -> int:
    """Show a camera until Ctrl-C, the window's end or for `seconds`; the exit code."""
    try:
        require_screen()
    except ViewerError:
        return print_error("no screen here, neither DISPLAY nor WAYLAND_DISPLAY is set; give --save FILE")
    connection.subscribe(TICK)
    try:
        with Window(free_port(), _MEMORY, headless=False) as window:
            view = CameraWindow(connection, pictures, camera)
            view.show.to_window(window.url)
            until = time.monotonic() + (math.inf if seconds is None else seconds)
            while time.monotonic() < until and window.is_open() and not stopping.wait(_TURN):
                set_tcp_options()
                view.update()
            if window.is_open():
                view.show.close()
            return _DONE if view.has_seen else _FAILED
    except ViewerError as error:
        print_error(str(error))
        pictures.close()
        sys.stdout.flush()
    os._exit(_FAILED)  # rerun would go on trying to send to a window that is gone


class CameraWindow:
    """What a camera sees, drawn by rerun with its age."""

    def __init__(self, connection: RobotConnection, pictures: PictureReceiver, camera: str) -> None:
        self._connection, self._pictures, self._camera = connection, pictures, camera
        self._ahead_ns = 0
        """Wall clock minus this host's, which what is heard is stamped with."""
        self.show = Show(stock(connection.robot), live=True, camera=camera)
        self.has_seen = False

    def update(self) -> None:
        """Draw what has come."""
        self._ahead_ns = time.time_ns() - robot_now_ns()
        self._connection.dispatch(self)
        if (picture := self._pictures.ask(self._camera, time.monotonic())) is not None:
            self.has_seen = True
            self.show.on_sample(CAMERA, picture, time.time_ns())
        for trouble in self._pictures.new_troubles():
            print_error(trouble)
        self.show.update(time.time_ns())

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As `Listener` has it."""
        del key
        if isinstance(sample, Tick):
            self.show.on_sample(topic, sample, at_ns + self._ahead_ns)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """As `Listener` has it."""
