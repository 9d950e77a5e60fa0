"""`giraff stop` by its plan: stop first, complain after."""

import shlex
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Final

from giraff_cli.estop import client
from giraff_cli.estop.page import PageStop, Place, place_of
from giraff_cli.estop.plan import StopPlan, plan_stop
from giraff_core.network import host_and_port
from giraff_node.network.consent import NoRobotError
from giraff_node.network.query_client import engaging
from giraff_node.network.reach import address_fault
from giraff_schemas.text import meant, printable_lines
from giraff_tools.network.command import UNUSABLE, UnopenedError, print_error, visit
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.output import discard_stdout
from giraff_tools.terminal.program import called_here, user_at_host
from giraff_tools.terminal.text import json_line

_LOOK: Final = 0.05  # s
_HINT_AFTER: Final = 1.0  # s; a robot that is there has mostly confirmed by then
_SAID_TWICE: Final = ("stop", "engage")
_VERBS: Final = ("reset", "status", *_SAID_TWICE)


def engage_each(names: Sequence[str], robot: str | None, *how: Any, **more: Any) -> int:
    """Stop the robots of these names at the same time, and return the worst exit code.

    Without a name, `engage_by_plan` decides which robots stop. A person in a hurry may say it twice, so `stop` and
    `engage` are not taken for names.
    """
    names = [each for each in names if each.strip() and each.lower() not in _SAID_TWICE]
    named: list[str] = list(dict.fromkeys([*([robot] if robot else []), *names]))

    def stop(each: str | None) -> int:
        return engage_by_plan(each, *how, is_word=each in names, **more)

    if len(named) <= 1:
        return stop(next(iter(named), None))
    with ThreadPoolExecutor(len(named)) as pool:
        return max(pool.map(stop, named))


def engage_by_plan(
    robot: str | None,
    connect: Sequence[str],
    reason: str,
    timeout: float,
    page: str = "",
    *,
    is_word: bool = False,
    off: bool = False,
    as_json: bool = False,
) -> int:
    """Stop the robot, or every robot that is heard, wherever it can be reached; the exit code.

    `page`: HOST:PORT of its page; empty: the pages that a visit has kept are asked. `as_json`: as of `tell`.
    `is_word`: the name may be a word that was meant for something else.
    """
    # A robot that is reached another way is stopped, whatever is wrong with the address that was typed.
    faults = {address: fault for address in connect if (fault := address_fault(address))}
    try:
        plan = plan_stop(robot, [address for address in connect if address not in faults])
    except NoRobotError as error:
        if is_word:
            print_error(_hint(robot or ""))
        return print_error(f"NOTHING IS STOPPED: {error}")
    stop = _Stop(plan, robot or "", connect, reason, timeout, faults, page, off=off)
    stop.report = partial(print_result, as_json=as_json)
    if is_word and not plan.doubt:
        stop.hint = _hint(robot or "")
    stop.start()
    return stop.end()


def _hint(word: str) -> str:
    all_of_them = shlex.join([*called_here(), "stop"])
    return f"{word} has not confirmed a stop; {meant(word, _VERBS)}`{all_of_them}` stops every robot that is heard"


class _Stop(threading.Thread):
    """The stop over Zenoh, in a thread: its handshakes may take half a minute, and the page waits for none of them."""

    def __init__(
        self,
        plan: StopPlan,
        robot: str,
        connect: Sequence[str],
        reason: str,
        timeout: float,
        faults: Mapping[str, str],
        page: str,
        *,
        off: bool,
    ) -> None:
        """`robot`, `connect` and `page`: as they were typed. `faults`: of the addresses of `connect`."""
        super().__init__(name="stop", daemon=True)
        self._plan, self._connect, self._reason, self._timeout, self._faults = plan, connect, reason, timeout, faults
        named, filed = (plan.target.robot, plan.target.filed) if plan.target else (robot, "")
        self._is_one = bool(named) and (plan.target is None or len(plan.target.network.connect) < client.SEVERAL)
        self._place: Place | None = None
        self._page_fault = ""
        try:
            self._place = place_of(page) if page else None
        except ValueError as error:
            self._page_fault = f"--page is left out: {error}"
        at = [host_and_port(address)[0] for address in connect if address not in faults]
        self._off = off
        self._page = PageStop(named or filed, self._place, timeout, plan.doubt, at, off=off)
        self.report = partial(print_result)
        self.hint = ""
        """It is told once if the robot has not confirmed after a second: the word may be no name. Empty: no hint."""
        self._code = UNUSABLE
        self._error: BaseException | None = None

    def run(self) -> None:
        try:
            self._code = self._over_zenoh()
        except BaseException as error:  # noqa: BLE001  raised again in the main thread
            self._error = error

    def end(self) -> int:
        """Wait until one of the ways has confirmed, or none of them does; say so. The exit code."""
        page = self._page
        stopped_by, told_code = "", client.RELEASED
        hint_at = time.monotonic() + _HINT_AFTER
        # A page that says that the robot is not off may speak too early: it is not the last word.
        while self.is_alive() and not (stopped_by and self._is_one and told_code == client.RELEASED):
            self.join(_LOOK)
            if time.monotonic() > hint_at and not stopped_by:
                self._tell_hint()
            if not stopped_by and (stopped_by := page.confirmed):
                by_word = self._plan.target is None or self._plan.target.network.is_open
                told_code, what = client.what_stands(is_off=page.is_off, off=self._off, by_word=by_word)
                told = f"{page.robot}: {what}, told by its page at {stopped_by}"
                self.report(client.Result(told_code, told, page.robot, engaged=True, off=page.is_off))
        if self._error is not None:
            raise self._error
        code = self._code
        if stopped_by:
            code = min(code, told_code) if self._is_one else max(code, told_code)
        if (told := page.unconfirmed) and not stopped_by and (code == client.UNKNOWN or self._place):
            code = self.report(client.Result(client.UNKNOWN, told, page.robot or None))
        if code == client.UNKNOWN:
            self._tell_hint()
        if self._page_fault:
            print_error(self._page_fault)
        if self._plan.complaint:
            print_error(self._plan.complaint)
        return code

    def _tell_hint(self) -> None:
        hint, self.hint = self.hint, ""
        if hint:
            print_error(hint)

    def _over_zenoh(self) -> int:
        fault = ""
        if self._plan.target is not None:
            try:
                return visit(self._plan.target, self._act, patience=self._timeout)
            except UnopenedError as error:
                fault = str(error)
        is_stopped = bool(self._page.stopped())
        if fault and not (self._is_one and is_stopped):
            print_error(f"NOTHING IS STOPPED: use the battery switch; {fault}")
        return UNUSABLE

    def _act(self, connection: RobotConnection) -> int:
        plan, page = self._plan, self._page
        if connection.robot and not plan.doubt:
            connection.ask_page()
        by, reason, off = user_at_host(), self._reason, self._off
        if not self._is_one:
            wish = engaging(by, reason, off=off)
            return client.engage_all(
                connection, wish, self._timeout, self._connect, self.report, doubt=plan.doubt, other=page
            )
        result = client.engage(connection, by, reason, self._timeout, off=off, doubt=plan.doubt, other=page)
        if result.code != client.UNKNOWN:
            self.hint = ""
            page.end(connection.robot)
        elif page.stopped():
            return client.what_stands(is_off=page.is_off, off=self._off)[0]
        for address, fault in self._faults.items():
            print_error(f"--connect {address} is left out: {fault}")
        code = self.report(result)
        if code == client.UNKNOWN and (hint := client.hint_of_others(connection)):
            print_error(hint)
        return code


def print_result(result: client.Result, *, as_json: bool = False) -> int:
    """Print how it ended; the exit code. A closed output ends no stop of another robot.

    `as_json`: as a line of JSON on standard output, for each robot one.
    """
    out = sys.stderr if result.code >= UNUSABLE and not as_json else sys.stdout
    try:
        line = json_line(result._asdict()) if as_json else printable_lines(result.text)
        print(f"{line}\n", end="", file=out, flush=True)  # at once: beside it, another robot's stop may be told
    except OSError:
        if out is sys.stdout:
            discard_stdout()
    return result.code
