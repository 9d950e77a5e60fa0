"""Where `giraff view` shows a robot: a window, a browser, a file or a picture."""

import os
import sys
from collections.abc import Iterable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Final, NamedTuple, NoReturn

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_node.network.host_addresses import host_addresses
from giraff_schemas.text import printable
from giraff_tools.network.command import print_error
from giraff_tools.network.ports import free_port
from giraff_tools.terminal.text import json_line
from giraff_viewer.machine import NO_VULKAN, has_vulkan
from giraff_viewer.scene import stock
from giraff_viewer.show import Show, require_screen
from giraff_viewer.window import ViewerError, Window

DONE: Final = 0
FAILED: Final = 1
DEFAULT_PORT: Final = 9090


class Options(NamedTuple):
    """What was asked for on the command line."""

    save: Path | None
    picture: Path | None
    web: bool
    port: int | None
    memory: str
    seconds: float | None
    as_json: bool
    camera: bool = False
    """Ask the cameras of a live robot for their pictures."""


class ViewerOutput(ExitStack):
    """Where one robot is shown, as asked for. All is closed with it."""

    def __init__(self, robot: RobotConfig, options: Options, *, live: bool, note: str = "") -> None:
        """Raises ViewerError. `note`: as `Scene` has it."""
        super().__init__()
        self._options = options
        self.name = robot.name
        self.show = Show(robot, live=live, still=options.picture is not None, note=note)
        self.window: Window | None = None
        self.address = ""
        if options.save is not None:
            self.show.to_file(options.save)
        elif options.web:
            port = options.port or DEFAULT_PORT
            self.show.to_browsers(port, port + 1, options.memory)
            self.address, *others = browser_addresses(host_addresses(), port)
            for address in (self.address, *others):
                print(f"giraff view: open {address}", file=sys.stderr, flush=True)
        else:
            headless = options.picture is not None
            if not headless:
                require_screen()
            elif not has_vulkan():
                raise ViewerError(NO_VULKAN)
            self.window = self.enter_context(Window(free_port(), options.memory, headless=headless))
            self.show.to_window(self.window.url)

    @property
    def is_open(self) -> bool:
        """Whether anybody may still look. Raises ViewerError."""
        return self.window is None or self.window.is_open()

    @property
    def lasts(self) -> bool:
        """There is something to look at after everything was drawn."""
        return self._options.save is None and self._options.picture is None

    def end(self, *, hurried: bool) -> int:
        """Everything was drawn; the exit code. `hurried`: without a picture. Raises ViewerError."""
        if self._options.web:
            self.show.flush()  # closing would end what serves it
        else:
            self.show.close()
        if self.window is not None and self._options.picture is not None and not hurried:
            self.window.picture(self._options.picture, self.show.newest)
        if self._options.as_json:
            told = {
                "robot": self.name,
                "samples": self.show.heard,
                "address": self.address or None,
                "file": str(self._options.save or self._options.picture or "") or None,
            }
            print(json_line(told), flush=True)
        elif (file := self._options.save or self._options.picture) is not None and file.exists():
            print(f"written: {printable(str(file))}", flush=True)
        return DONE


def browser_addresses(hosts: Iterable[str], port: int) -> list[str]:
    """Return what opens the viewer in a browser: on other machines by each address of this one, then on this one.

    The data are at the next port. The browser fetches them from where it has the page from.
    """
    return [
        f"http://{host}:{port}/?url=rerun%2Bhttp://{host}:{port + 1}/proxy&theme=dark"
        for host in (*sorted(hosts), "127.0.0.1")
    ]


def give_up(error: ViewerError) -> NoReturn:
    """End with what the viewer has failed with, at once: rerun would go on trying to send to it what is left."""
    print_error(str(error))
    sys.stdout.flush()
    os._exit(FAILED)


def known_robot(name: str) -> tuple[RobotConfig, str]:
    """Return the geometry of a robot that does not tell it, and a note that says whose it is.

    This machine's robot file may be of another robot.
    """
    with suppress(ConfigError):
        if (robot := load("robot", RobotConfig)).name == name:
            return robot, f"drawn by the file {robot_file(os.environ)}"
    return stock(name), "drawn as a stock Giraff"
