"""`giraff view`: hears a robot, or reads a recording of one, and has it drawn."""

import math
import shlex
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from giraff_cli.view.output import DONE, Options, ViewerOutput, give_up, known_robot
from giraff_core.robot import RobotConfig
from giraff_node import robot_now_ns
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.network.tokens import list_robots
from giraff_schemas.messages import Sample
from giraff_schemas.params import ParamAnswer
from giraff_schemas.requests import OdomEchoes
from giraff_schemas.topics import ODOM_ECHOES, Topic
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_base, limits_of
from giraff_tools.network.pictures import pictures_for
from giraff_tools.terminal.program import user_at_host
from giraff_tools.terminal.signals import StopSignal
from giraff_viewer.machine import require_memory
from giraff_viewer.window import ViewerError

_TURN: Final = 0.03  # s between two looks at what was heard
_ASK_FOR: Final = 3.0  # s, what was heard before: a robot that comes later begins then
_SHAPE_WITHIN: Final = 1.0
"""s that nothing is drawn before the robot has told its shape. It is asked for longer, and then drawn anew."""
_TELL_AFTER: Final = 3.0  # s without a word of the robot


def show(recording: Path | None, robot: str | None, connect: Sequence[str], options: Options) -> int:
    """The whole of it; the exit code."""
    if recording is not None and (robot is not None or connect):
        return print_error("--robot and --connect are for a live robot; a recording is of one already")
    if refusal := _refusal(recording, options):
        return print_error(refusal)
    with StopSignal() as stopping:
        if recording is not None:
            from giraff_cli.view.recording import RecordingViewer  # noqa: PLC0415  needs the extra `record`

            return RecordingViewer(recording, options, stopping).run()
        return run_with_robot(robot, connect, lambda met: LiveViewer(met, options, stopping).run())


class LiveViewer:
    """A robot that is heard now."""

    def __init__(self, connection: RobotConnection, options: Options, stopping: StopSignal) -> None:
        self._connection = connection
        self._options = options
        self._stopping = stopping
        self._stage: ViewerOutput | None = None
        self._pictures = pictures_for(connection, "view") if options.camera else None
        self._shape = ask_base(connection)
        self._earlier = QueryClient(connection.session, connection.robot, ODOM_ECHOES, OdomEchoes(by=user_at_host()))
        self._ahead_ns = 0
        """Wall clock minus the robot's, which what is heard is stamped with."""

    def run(self) -> int:
        """Until Ctrl-C, the viewer's end or --for; the exit code."""
        told = self._robot_in(self._shape.wait(time.monotonic() + _SHAPE_WITHIN))
        robot, note = known_robot(self._connection.robot) if told is None else (told, "")
        try:
            stage = ViewerOutput(robot, self._options, live=True, note=note)
        except ViewerError as error:
            return print_error(str(error))
        try:
            with stage as self._stage:
                self._connection.subscribe_all()
                self._draw(self._stage, is_shaped=told is not None)
                if not self._stage.show.heard and not self._stopping.asked:
                    return print_error(self._unheard())
                return self._stage.end(hurried=self._stopping.asked > 0) if self._stage.is_open else DONE
        except ViewerError as error:
            give_up(error)
        finally:
            if self._pictures is not None:
                self._pictures.close()

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Of the connection."""
        if self._pictures is not None:
            self._pictures.on_sample(topic, key, sample, at_ns)
        assert self._stage is not None  # noqa: S101  it is there as long as anybody listens
        self._stage.show.on_sample(topic, sample, at_ns + self._ahead_ns)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Of the connection."""
        assert self._stage is not None  # noqa: S101
        self._stage.show.on_liveliness(service, instance, time.time_ns(), present=present)

    def _robot_in(self, answer: ParamAnswer | None) -> RobotConfig | None:
        """Return the robot that base tells; None: it tells none that can be."""
        with suppress(NoRobotError):
            return None if answer is None else limits_of(answer, self._connection.robot)
        return None

    def _unheard(self) -> str:
        return not_found_text(self._connection.robot, list_robots(self._connection.session))

    def _draw(self, stage: ViewerOutput, *, is_shaped: bool) -> None:
        began, told, is_asking = time.monotonic(), False, True
        heard_at = began
        until = began + (math.inf if self._options.seconds is None else self._options.seconds)
        while (now := time.monotonic()) < until and stage.is_open and not self._stopping.wait(_TURN):
            set_tcp_options()
            self._ahead_ns = time.time_ns() - robot_now_ns()
            self._connection.dispatch(self)
            if is_asking and now - began < _ASK_FOR and (earlier := self._earlier.poll(now)) is not None:
                stage.show.begin_with(earlier)
                is_asking = False
            heard_at = heard_at if stage.show.heard else now
            if not is_shaped and now - heard_at < _ASK_FOR and (robot := self._robot_in(self._shape.poll(now))):
                stage.show.draw(robot, time.time_ns())
                is_shaped = True
            if self._pictures is not None:
                for seen in self._pictures.ask_all(now):
                    stage.show.on_sample(*seen, time.time_ns())
                for trouble in self._pictures.new_troubles():
                    print_error(trouble)
            stage.show.update(time.time_ns())
            if not told and not stage.show.heard and now - began > _TELL_AFTER:
                told = True
                print_error(f"{self._unheard()}; waiting for it")


def _refusal(recording: Path | None, options: Options) -> str:
    """What is wrong with what was asked for."""
    if options.seconds is not None and not (math.isfinite(options.seconds) and options.seconds > 0.0):
        return f"--for {options.seconds:g}: give a positive number of seconds, or leave it out to go on until Ctrl-C"
    if recording is not None and (options.camera or options.seconds is not None):
        return "--camera and --for are for a live robot; a recording is drawn to its end, with the pictures in it"
    if recording is not None and recording.suffix == ".rrd":
        return f"{recording}: rerun itself opens what --save has written: rerun {shlex.quote(str(recording))}"
    if recording is not None and options.save is not None and options.save.resolve() == recording.resolve():
        return f"--save {options.save}: it is the recording itself, which would be lost; name another file"
    if options.picture is not None and recording is None and options.seconds is None:
        return "--picture of a live robot: say when, with --for SECONDS"
    try:
        require_memory(options.memory)
    except ValueError as error:
        return f"--memory: {error}"
    return _output_refusal(options)


def _output_refusal(options: Options) -> str:
    """Return what is wrong with where it is to be shown."""
    if sum((options.save is not None, options.picture is not None, options.web)) > 1:
        return "--save, --picture and --web: one at a time"
    if options.port is not None and not options.web:
        return f"--port {options.port}: it is for --web; add --web, or leave it out"
    if options.picture is not None and options.picture.suffix != ".png":
        return f"--picture {options.picture}: it is written as PNG; give a name that ends in .png"
    if options.picture is not None and not options.picture.absolute().parent.is_dir():
        return f"--picture {options.picture}: there is no such folder; make it first"
    return ""
