"""`giraff estop`: stop a robot from any machine, and release it again.

Each answers with an exit code and a word for people. Nothing is taken for done before base has said so.
"""

import contextlib
import functools
import shlex
import time
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Final, NamedTuple

from giraff_core.estop.request import BY_WORD, board_note, not_off, stop_word
from giraff_core.latest import LatestSamples
from giraff_node import robot_now_ns
from giraff_node.config.robot_file import DEFAULT_FILE
from giraff_node.network.discovery import HOW_TO_REACH, RobotMonitor, host_of, others
from giraff_node.network.query_client import EStopClient, QueryClient, engaging
from giraff_node.network.reach import find_silent
from giraff_schemas.messages import EStop, RobotTime
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.text import printable
from giraff_schemas.topics import ESTOP, ESTOP_RESET, TICK, key_of
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.program import called_here

if TYPE_CHECKING:
    from giraff_cli.estop.witness import Witness

RELEASED: Final = 0
ENGAGED: Final = 1
UNKNOWN: Final = 2

_TURN: Final = 0.01  # s
SEVERAL: Final = 2
"""Addresses at which there may be several robots of one name."""
_LEAST: Final = 0.5  # s
_NEWCOMERS: Final = 1.0  # s after the last one was met; the others of a network are met within some ten ms
_MOST_TOLD: Final = 20  # robots that did not confirm; on an open network anybody may declare a name
_TWO_PERIODS: Final = 2.5 / ESTOP.rate_hz  # s in which every base has told its state


class Result(NamedTuple):
    """How it ended."""

    code: int
    text: str
    robot: str | None = None
    engaged: bool | None = None
    """Unknown where it is None, as each of these fields."""
    off: bool | None = None
    latch: int | None = None
    by: str | None = None
    """Who engaged the latch, or reset it."""
    reason: str | None = None


class OtherWay:
    """Asks a robot for the stop beside Zenoh. This one asks none."""

    def watch(self, robot: str, asking: EStopClient) -> None:
        """Take into account what base says to this request over Zenoh."""

    def end(self, robot: str) -> None:
        """Ask this robot no more: it has confirmed over Zenoh."""

    def stopped(self) -> set[str]:
        """Wait until it is known which robots have confirmed this way, and return them."""
        return set()


ZENOH_ALONE: Final = OtherWay()


def engage(
    connection: RobotConnection,
    by: str,
    reason: str,
    timeout: float,
    *,
    off: bool = False,
    doubt: str = "",
    other: OtherWay = ZENOH_ALONE,
) -> Result:
    """Ask again and again until each base of this name confirms that it has stopped and will stay so. 0: it has.

    `off`: asks for off; the code is ENGAGED where base has stopped the robot, and its drive has no other off.
    `doubt`: why it is not known whether the robot that answers is the one that is meant; then the code is UNKNOWN.
    `other`: asks meanwhile, too.
    """
    robot, deadline = connection.robot, time.monotonic() + _left(connection, timeout)
    wish = engaging(by, reason, off=off)
    asking = EStopClient(connection.session, robot, wish)
    other.watch(robot, asking)
    answer = asking.wait(deadline)
    if doubt and (answer or _has_stopped(asking)):
        return _doubtful(connection, asking, robot, doubt)
    if answer is not None:
        other.end(robot)
        from giraff_cli.estop.witness import Witness  # noqa: PLC0415  no stop waits for it

        return _confirmed(Witness(connection, wish), robot, answer, asking)
    return _unconfirmed(robot, asking, timeout)


def hint_of_others(connection: RobotConnection) -> str:
    """Name the other robots on the network, for a person whose robot did not confirm; empty: there are none."""
    return others(connection.session, connection.robot).removeprefix("; ")


def engage_all(
    connection: RobotConnection,
    wish: EStopEngage,
    timeout: float,
    addresses: Sequence[str],
    tell: Callable[[Result], object],
    *,
    doubt: str = "",
    other: OtherWay = ZENOH_ALONE,
) -> int:
    """The same of each robot of the connection's name; where it has none, of every robot that is heard. The worst code.

    `tell` is given each result as soon as there is one. `other`: asks one of them meanwhile, too.
    Listens until a second after the last newcomer, and no longer than `timeout`. `addresses`: where somebody takes a
    robot to be. One at which nobody answers stops no other robot's stop, and is told.
    """
    with ThreadPoolExecutor(1) as pool:
        silent = pool.submit(find_silent, addresses)
        teller = _Teller(tell)
        code = _engage_heard(connection, wish, timeout, teller, doubt, other)
        teller.end()
        lost = silent.result()
        for address in connection.unreached(addresses) if len(addresses) >= SEVERAL else ():
            lost.setdefault(address, "what listens there does not answer as a door")
        for address, why in lost.items():
            told = f"--connect {address}: {why}; NOT REACHED: a robot there was NOT STOPPED, use its battery switch"
            tell(Result(UNKNOWN, told))
            code = UNKNOWN
    return code


def _engage_heard(
    connection: RobotConnection,
    wish: EStopEngage,
    timeout: float,
    tell: Callable[[Result], object],
    doubt: str,
    other: OtherWay,
) -> int:
    doors = [(connection.session, RobotMonitor(connection.session))]
    connection.open_other_doors(lambda session: doors.append((session, RobotMonitor(session))))
    asking: dict[tuple[str, int], EStopClient] = {}  # of each door: the robots at two may have one name
    stopped: set[tuple[str, int]] = set()
    codes = [UNKNOWN if doubt else RELEASED]
    tell_once = functools.cache(tell)  # one robot may be heard at two doors
    teller = ThreadPoolExecutor(1)  # what is looked up for a sentence takes up to 0.5 s, in which the others are asked
    from giraff_cli.estop.witness import Witness  # noqa: PLC0415

    witness, confirmed = Witness(connection, wish), list[Future[int]]()
    newest = time.monotonic()
    until = newest + _left(connection, timeout)
    while (now := time.monotonic()) < until:
        for at, robot in ((at, robot) for at, (_, monitor) in enumerate(doors) for robot in monitor.all_names):
            # Each by its own key: rules of a secured network pass none with a wildcard.
            if (robot, at) not in asking and connection.robot in {"", robot}:
                asking[robot, at] = EStopClient(doors[at][0], robot, wish)
                other.watch(robot, asking[robot, at])
                newest = now
        for robot, at in sorted(asking.keys() - stopped):
            if (answer := _poll(asking[robot, at], now)) is not None:
                stopped.add((robot, at))
                if doubt:
                    teller.submit(_tell_doubtful, connection, asking[robot, at], robot, doubt, tell)
                else:
                    other.end(robot)
                    way = asking[robot, at]
                    confirmed.append(teller.submit(_tell_confirmed, witness, robot, answer, way, tell_once))
        is_alone = now - newest > _NEWCOMERS and not connection.is_looking
        if asking and len(stopped) == len(asking) and is_alone:
            break
        time.sleep(_TURN)
    teller.shutdown()
    codes += [told.result() for told in confirmed]
    elsewhere = other.stopped()
    not_stopped = [way for way in asking.keys() - stopped if way[0] not in elsewhere]
    open_ones = sorted(not_stopped, key=lambda way: _weight(connection, asking[way], way[0]))
    for robot, at in open_ones:
        result = _unconfirmed(robot, asking[robot, at], timeout, whose=f"{robot}: ")
        if doubt and _has_stopped(asking[robot, at]):
            result = _doubtful(connection, asking[robot, at], robot, doubt)
        tell(result)
        codes.append(result.code)
    # A page tells of one robot, and at several addresses there may be several of one name.
    met = {robot for robot, _ in asking} | (elsewhere if len(connection.network.connect) < SEVERAL else set())
    return max(codes) if _are_all(connection, met, tell) else UNKNOWN


def _left(connection: RobotConnection, timeout: float) -> float:
    """Return what is left of the time, where a door had to be waited for."""
    return max(_LEAST, timeout - (connection.waited or 0.0))


def _weight(connection: RobotConnection, asking: EStopClient, robot: str) -> tuple[bool, bool, str]:
    """Sort the robot of the robot file first, then those that answer: of a long list only the first are told."""
    return robot != connection.filed, not asking.is_answered, robot


class _Teller:
    """Tells results, of those without a confirmation only the first: anybody may declare names."""

    def __init__(self, tell: Callable[[Result], object]) -> None:
        self._tell = tell
        self._unknown = 0

    def __call__(self, result: Result) -> None:
        self._unknown += result.code == UNKNOWN
        if result.code != UNKNOWN or self._unknown <= _MOST_TOLD:
            self._tell(result)

    def end(self) -> None:
        """Tell how many were left out."""
        if (more := self._unknown - _MOST_TOLD) > 0:
            self._tell(Result(UNKNOWN, f"and {more} more: NOT CONFIRMED; use the battery switch"))


def _are_all(connection: RobotConnection, asked: Collection[str], tell: Callable[[Result], object]) -> bool:
    """Tell of robots that were not met, if there must be some."""
    if not asked:
        tell(Result(UNKNOWN, f"NOTHING IS STOPPED: no robot is heard; use the battery switch, then {HOW_TO_REACH}"))
    if connection.filed and connection.filed not in asked:
        told = f"{connection.filed}, which {DEFAULT_FILE} names, is NOT HEARD and was not stopped"
        tell(Result(UNKNOWN, told, connection.filed))
    return bool(asked)


def _poll(asking: EStopClient, now: float) -> EStopAnswer | None:
    """Ask one robot. An error becomes the fault of this request, so that the other robots are still asked."""
    try:
        return asking.poll(now)
    except Exception as error:  # noqa: BLE001  nothing that one name brings about may end the stop of another robot
        asking.fault = f"{asking.key}: {error}"
        return None


def _has_stopped(asking: EStopClient) -> bool:
    """Tell whether base has stopped, but cannot keep it over a restart."""
    return asking.refusal is not None and asking.refusal.engaged


def _doubtful(connection: RobotConnection, asking: EStopClient, robot: str, doubt: str) -> Result:
    """Tell of a robot that has confirmed, and may be another of that name."""
    host = ""
    with contextlib.suppress(Exception):  # the robot is told of, whatever its lookup meets
        host = host_of(connection.session, robot)
    word = f", {BY_WORD}" if connection.network.is_open else ""
    has = "was asked to stop" if asking.note else "has stopped"
    told = f"a robot called {robot} at {host or 'an unknown host'} {has}{word}{asking.note}; {doubt}"
    return Result(UNKNOWN, printable(told), robot)


def _tell_doubtful(
    connection: RobotConnection, asking: EStopClient, robot: str, doubt: str, tell: Callable[[Result], object]
) -> None:
    tell(_doubtful(connection, asking, robot, doubt))


def what_stands(*, is_off: bool, off: bool, by_word: bool = False, note: str = "") -> tuple[int, str]:
    """Return the code and the words of a stop that base has confirmed. `off`: it was asked for.

    `by_word`: a stranger may have confirmed it in base's place. `note`: of a board that is not heard.
    """
    code, what = (ENGAGED, not_off(note)) if off and not is_off else (RELEASED, "OFF" if is_off else stop_word(note))
    return code, f"{what}, {BY_WORD}" if by_word else what


def _confirmed(witness: "Witness", robot: str, answer: EStopAnswer, asking: EStopClient) -> Result:
    connection, is_off = witness.connection, asking.is_off
    by_word = connection.network.is_open and not witness.has_heard(robot, answer.instance)
    way = [word for address in connection.network.connect for word in ("--connect", address)]
    release = shlex.join([*called_here(), "estop", "reset", "--robot", robot, *way])
    code, what = what_stands(is_off=is_off, off=witness.wish.off, by_word=by_word, note=asking.note)
    told = f"{robot}: {what}, latch {answer.id}{asking.note}; it stays so until `{release}`"
    return Result(code, told, robot, answer.engaged, is_off, answer.id)


def _tell_confirmed(
    witness: "Witness", robot: str, answer: EStopAnswer, asking: EStopClient, tell: Callable[[Result], object]
) -> int:
    result = _confirmed(witness, robot, answer, asking)
    tell(result)
    return result.code


def _of_state(code: int, text: str, robot: str, state: EStop) -> Result:
    return Result(code, text, robot, state.engaged, state.off, state.id, state.by, str(state.reason))


def _unconfirmed(robot: str, asking: EStopClient, timeout: float, whose: str = "") -> Result:
    refusal, several = asking.refusal, asking.unconfirmed
    reason = "" if refusal is None else printable(str(refusal.reason))
    if refusal is not None and refusal.engaged and not several:
        note = board_note(refusal.unheard_stops_s)
        told = f"{robot}: {stop_word(note)}, latch {refusal.id}{note}, but not for sure after a restart: {reason}"
        return Result(ENGAGED, told, robot, refusal.engaged, None, refusal.id)
    refused = refusal is not None and not refusal.engaged
    known = [several, f"{asking.key} answers that it has not stopped: {reason}" if refused else ""]
    why = "; ".join(filter(None, known)) or asking.fault or f"nobody answered {asking.key}"
    told = f"{whose}NOT CONFIRMED after {timeout:g} s: {why}; use the battery switch, then {HOW_TO_REACH}"
    return Result(UNKNOWN, told, robot)


def reset(connection: RobotConnection, by: str, timeout: float) -> Result:
    """Clear the latch that is engaged now, and no other. 0: no latch is engaged any more."""
    robot, deadline = connection.robot, time.monotonic() + timeout
    states = _listen(connection, deadline)
    if not states:
        return _silent(connection, timeout)
    if len(states) > 1:
        return Result(UNKNOWN, f"UNKNOWN: {_several(robot, states)}", robot)
    [state] = states
    if not state.engaged:
        return _of_state(RELEASED, f"{robot}: not engaged, nothing to clear; {_HOW_TO_DRIVE}", robot, state)
    what = printable(f"latch {state.id} of {robot}, engaged by {state.by}: {state.reason.what}")
    tick = _next_tick(connection, deadline)
    if tick is None:
        told = f"NOT CLEARED, {what}: the robot's clock is not heard on {key_of(robot, TICK)}; restart giraff_base"
        return _of_state(UNKNOWN, told, robot, state)
    asking = QueryClient(
        connection.session, robot, ESTOP_RESET, EStopReset(by=by, id=state.id, tick=tick, engaged_ns=state.engaged_ns)
    )
    answer = asking.wait(deadline)
    if answer is None:
        told = f"NOT CONFIRMED after {timeout:g} s, {what}: {asking.fault or f'nobody answered {asking.key}'}"
        return _of_state(UNKNOWN, told, robot, state)._replace(engaged=None, off=None)
    if not answer.done or answer.engaged:
        why = printable(str(answer.reason)) or f"latch {answer.id} has come since"
        kept = (state.by, str(state.reason)) if answer.id == state.id else (None, None)
        return Result(ENGAGED, f"STILL ENGAGED, {what}: {why}", robot, answer.engaged, None, answer.id, *kept)
    how = f"{_HOLD_IT}; {_HOW_TO_DRIVE}" if state.off else _HOW_TO_DRIVE
    told = f"cleared {what}\n{robot} may move again, and does not yet: {how}"
    return _of_state(RELEASED, told, robot, state)._replace(engaged=False, off=False)


def status(connection: RobotConnection, timeout: float) -> Result:
    """Whether it is engaged, by whom and why."""
    robot = connection.robot
    states = _listen(connection, time.monotonic() + timeout)
    if not states:
        return _silent(connection, timeout)
    told = [
        f"{robot}: {'OFF' if state.off else 'ENGAGED' if state.engaged else 'released'}, latch {state.id}"
        + printable((f", by {state.by}" if state.by else "") + (f": {state.reason}" if state.reason else ""))
        for state in states
    ]
    code = ENGAGED if any(state.engaged for state in states) else RELEASED
    if len(states) > 1:
        return Result(code, "\n".join([*told, _several(robot, states)]), robot)
    return _of_state(code, told[0], robot, states[0])


_HOW_TO_DRIVE: Final = "to drive, hold the hand level until it is armed"
_HOLD_IT: Final = "it is off, so hold it upright and still"


def _listen(connection: RobotConnection, deadline: float) -> list[EStop]:
    """The state of every base of this name; none where none is heard before `deadline`."""
    heard = LatestSamples()
    connection.subscribe_all((ESTOP, TICK))
    until = deadline
    while time.monotonic() < until:
        connection.dispatch(heard)
        if until == deadline and heard.latest(ESTOP, robot_now_ns()):
            until = min(deadline, time.monotonic() + _TWO_PERIODS)
        time.sleep(_TURN)
    return [each.sample for each in heard.all(ESTOP, robot_now_ns())]


def _next_tick(connection: RobotConnection, deadline: float) -> RobotTime | None:
    """A moment of the robot's clock that comes after all that is known of it so far; None: it has stopped."""
    connection.dispatch(LatestSamples())
    later = LatestSamples()
    while (tick := later.latest(TICK, robot_now_ns())) is None and time.monotonic() < deadline:
        time.sleep(_TURN)
        connection.dispatch(later)
    return None if tick is None else tick.sample.time


def _silent(connection: RobotConnection, timeout: float) -> Result:
    key, hint = key_of(connection.robot, ESTOP), others(connection.session, connection.robot)
    told = f"UNKNOWN: nothing is heard on {key} after {timeout:g} s; {HOW_TO_REACH}{hint}"
    return Result(UNKNOWN, told, connection.robot)


def _several(robot: str, states: list[EStop]) -> str:
    return f"{len(states)} bases are called {robot} ({', '.join(each.instance for each in states)}); end all but one"
