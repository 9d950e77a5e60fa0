"""The simulated robot as a process: at the wall's pace, with a serial port a board and a control socket."""

import argparse
import gc
import json
import logging
import os
import select
import signal
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, get_args

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load
from giraff_node.process.logs import service_logger
from giraff_schemas.wire import BoardKind
from giraff_sim.board import Board, BoardError, Implementation
from giraff_sim.bodies.registry import read_drive, read_ranger, world_of
from giraff_sim.config import SimConfig
from giraff_sim.control.control import Control
from giraff_sim.control.server import ControlServer
from giraff_sim.devices import devices_of
from giraff_sim.hosts.cable import BoardUart, Device
from giraff_sim.ptys import SerialPort
from giraff_sim.simulation import Simulation, WallPacer, simulation
from giraff_sim.truth import Level, draw_truth
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.hand import Dropped, Hand, LaidDown, ScriptError, Shaken, StillHand, read_script
from giraff_sim.world.room import Room, RoomError, read_room

_log = logging.getLogger(__name__)

_CHORES_EVERY: Final = 256  # slices between two looks at what changes slowly


@dataclass(frozen=True, kw_only=True)
class Options:
    """The command line."""

    ports: Path
    control: Path
    world: Path
    seed: int
    truth: Level
    boards: Implementation
    only: tuple[BoardKind, ...]
    hand: str
    parent_pid: int | None


def parse(arguments: list[str]) -> Options:
    """The options, or an exit with a usage message."""
    parser = argparse.ArgumentParser(prog="giraff_sim", description=__doc__)
    add = parser.add_argument
    known = {kind.name.lower(): kind for kind in BoardKind}
    add("--ports", type=Path, required=True, metavar="DIR", help="directory for the boards' serial ports")
    add("--control", type=Path, required=True, metavar="PATH", help="control socket")
    add("--world", type=Path, required=True, metavar="FILE", help="room, as deploy/worlds/living_room.toml")
    add("--seed", type=int, default=1, metavar="N", help="of everything random (default 1)")
    add(
        "--truth",
        choices=get_args(Level),
        default="calibrated",
        help="how far the robot differs from its file (default calibrated)",
    )
    add("--boards", choices=[*Implementation], default="avr", help="what runs the firmware (default avr)")
    add("--only", default=",".join(known), metavar="NAMES", help="boards, separated by commas")
    add(
        "--hand",
        default="demo",
        metavar="demo|still|laid_down|shaken|dropped|FILE",
        help="who tilts the joystick (default demo)",
    )
    add("--parent-pid", type=int, metavar="PID", help="end when this process is no longer the parent")
    given = parser.parse_args(arguments)
    names = [name.strip() for name in given.only.split(",")]
    if unknown := [name for name in names if name not in known]:
        parser.error(f"--only: there is no board {unknown[0]!r}; there are {', '.join(known)}")
    return Options(
        ports=given.ports,
        control=given.control,
        world=given.world,
        seed=given.seed,
        truth=given.truth,
        boards=Implementation(given.boards),
        only=tuple(kind for name, kind in known.items() if name in names),
        hand=given.hand,
        parent_pid=given.parent_pid,
    )


def make_hand(name: str, room: Room, seed: int, begin: float) -> Hand:
    """A hand of the name that the command line and the control socket know; `begin`: simulated s."""
    match name:
        case "demo":
            return DemoHand(room.waypoints, seed, begin)
        case "still":
            return StillHand()
        case "laid_down":
            return LaidDown()
        case "shaken":
            return Shaken(begin)
        case "dropped":
            return Dropped(begin)
        case _:
            return read_script(Path(name), begin)


class Eeprom:
    """What a board keeps without power, in a file beside its port: a new run is a boot, not a new board."""

    def __init__(self, board: Board, directory: Path) -> None:
        self._board = board
        self._path = directory / f"{board.type.name}.eeprom"
        self._kept = b""
        with suppress(FileNotFoundError):
            board.keep_from(self._path.read_bytes())

    def keep(self) -> None:
        """Write the file when something has changed."""
        cells = self._board.eeprom
        if cells == self._kept:
            return
        fresh = self._path.with_suffix(".new")
        fresh.write_bytes(cells)
        fresh.replace(self._path)
        self._kept = cells


class Process:
    """The loop: a slice, the cables, the control socket, a wait."""

    def __init__(self, options: Options, running: Simulation, stack: ExitStack, devices: Mapping[str, Device]) -> None:
        """`devices`: those that are no boards, by the names of their ports."""
        self._parent_pid = options.parent_pid
        self._simulation = running
        self._pacer = WallPacer()
        self._slips_told = 0
        self._stopping = False
        boards = {
            kind: SerialPort(BoardUart(kind, running), options.ports / kind.name.lower()) for kind in running.boards
        }
        others = (SerialPort(device, options.ports / name) for name, device in devices.items())
        self._ports = [*boards.values(), *others]
        for port in self._ports:
            stack.callback(port.unplug)
            port.plug()
        self._eeproms = [Eeprom(board, options.ports) for board in running.boards.values()]

        def hand(name: str, begin: float) -> Hand:
            return make_hand(name, running.world.room, options.seed, begin)

        control = Control(running, boards, self._pacer, hand)
        self._server = ControlServer(options.control, control.answer)
        stack.callback(self._server.close)
        self._readable = select.epoll()
        stack.callback(self._readable.close)
        self._readable.register(self._server.listener, select.EPOLLIN)

    def stop(self) -> None:
        """End the loop after this slice."""
        self._stopping = True

    def run(self) -> None:
        """Until stopped, or orphaned."""
        slices = 0
        while not self._stopping:
            self._simulation.step()
            for port in self._ports:
                port.carry(self._simulation.now_us)
            self._serve()
            slices += 1
            if slices % _CHORES_EVERY == 0:
                self._chores()
            wait = self._pacer.wait(time.monotonic(), self._simulation.now_us)
            self._simulation.world.skew = self._pacer.skew
            if wait > 0.0:
                time.sleep(wait)
        for eeprom in self._eeproms:
            eeprom.keep()

    def _serve(self) -> None:
        for descriptor, _ in self._readable.poll(0):
            if descriptor == self._server.listener:
                client = self._server.accept()
                if client is not None:
                    self._readable.register(client, select.EPOLLIN)
            else:
                self._server.serve(descriptor)  # a closed one leaves the set by itself

    def _chores(self) -> None:
        for eeprom in self._eeproms:
            eeprom.keep()
        if self._pacer.slips != self._slips_told:
            self._slips_told = self._pacer.slips
            _log.warning("this machine was too slow: simulated time is %.3f s behind", self._pacer.skew)
        if self._parent_pid is not None and os.getppid() != self._parent_pid:
            _log.info("the process that started the simulator has ended")
            self.stop()


def main(arguments: list[str] | None = None) -> int:
    """Run the simulated robot until SIGTERM or SIGINT; the exit status."""
    options = parse(sys.argv[1:] if arguments is None else arguments)
    service_logger("giraff_sim")
    try:
        with ExitStack() as stack:
            robot, sim = load("robot", RobotConfig), load("sim", SimConfig)
            drive, ranger = read_drive(), read_ranger()
            room = read_room(options.world)
            hand = make_hand(options.hand, room, options.seed, 0.0)
            truth = draw_truth(options.truth, sim.truth, options.seed, robot.calibration)
            world = world_of(room, robot, drive, sim, hand, options.seed, truth=truth)
            running = stack.enter_context(simulation(world, options.only, options.boards, ranger=ranger))
            options.ports.mkdir(parents=True, exist_ok=True)
            devices = devices_of(robot, world)
            process = Process(options, running, stack, devices)
            for number in (signal.SIGTERM, signal.SIGINT):
                signal.signal(number, lambda _number, _frame: process.stop())
            names = [*(kind.name.lower() for kind in options.only), *devices]
            ports = {name: str(options.ports / name) for name in names}
            print(json.dumps({"ready": True, "control": str(options.control), "ports": ports}), flush=True)
            gc.collect()
            gc.freeze()  # what lives as long as the process need not be looked through every time
            process.run()
    except (BoardError, ConfigError, RoomError, ScriptError, ValueError, OSError) as error:
        _log.error("%s", error)
        return 1
    return 0
