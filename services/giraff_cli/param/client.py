"""`giraff param`: asks the services of a robot for what they go by, and asks them to go by something else."""

import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import msgspec

from giraff_cli.param.format import Shown, as_objects, differing, values
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tokens import find_tokens, list_robots
from giraff_schemas.checks import require_sendable
from giraff_schemas.params import ParamAnswer, ParamDescribe, ParamSave, ParamSet
from giraff_schemas.services import ANSWERING
from giraff_schemas.text import meant, near, plain, printable
from giraff_schemas.topics import PARAM_DESCRIBE, PARAM_SAVE, PARAM_SET, Query, alive_key, require_chunk
from giraff_tools.network.command import UNUSABLE, print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.program import user_at_host

_PATIENCE: Final = 3.0  # s, for a robot to be found, and then for its services to answer
_SAVE_PATIENCE: Final = 10.0  # s, for a slow disk
_SETTLED: Final = 0.5  # s after the first service was found: the others of a network are met within some ten ms
_TURN: Final = 0.02  # s

_TABLES: Final = ANSWERING | {"robot"}
_MOST: Final = 3  # names that are told for one word

_DONE: Final = 0
_WRONG: Final = 1

Answers = dict[str, ParamAnswer]
"""By service."""


def show(
    robot: str | None,
    connect: Sequence[str],
    names: Sequence[str],
    view: Callable[[Sequence[Shown]], None],
    *,
    as_json: bool,
) -> int:
    """Tell of the parameters `names`, which are fields or whole services; the exit code."""

    def report(connection: RobotConnection) -> int:
        is_known = all(name.partition(".")[0] in _TABLES for name in names)
        services = _services(connection, names if is_known else ())  # all of them know what was meant
        answers = _ask(connection, PARAM_DESCRIBE, dict.fromkeys(services, ParamDescribe()), _PATIENCE)
        shown = [Shown(each.service, each.host, param) for each in answers.values() for param in each.params]
        wanted = [one for one in shown if not names or any(one.is_meant(name) for name in names)]
        if unknown := [name for name in names if not any(one.is_meant(name) for one in shown)]:
            missing = services - answers.keys()
            if missing and (is_known or not shown):
                return print_error(_silent(missing))
            return print_error(_unknown(unknown[0], shown))
        for service in sorted(services - answers.keys()):
            print_error(_silent({service}))
        for words in (differences := differing(wanted)):
            print_error(words)
        if as_json:
            print_json(as_objects(wanted))
        else:
            view(wanted)
        return _WRONG if differences or len(answers) < len(services) else _DONE

    return run_with_robot(robot, connect, report)


def set_one(robot: str | None, connect: Sequence[str], name: str, text: str, *, as_json: bool) -> int:
    """Set `SERVICE.FIELD`; return the exit code."""
    service, dot, field = name.partition(".")
    if not dot and name not in _TABLES:
        return show(robot, connect, (name,), values, as_json=as_json)  # which tells what was meant
    if not dot:
        return print_error(f"{name}: name service and field, like guard.margin; `giraff param list {name}` has them")
    try:
        request = ParamSet(name=field, value=_value(text), by=user_at_host())
    except ValueError as error:
        return print_error(f"{name}: {error}")

    def report(connection: RobotConnection) -> int:
        services = _services(connection, (service,))
        return _told(
            _ask(connection, PARAM_SET, dict.fromkeys(services, request), _PATIENCE), services, as_json=as_json
        )

    return run_with_robot(robot, connect, report, moves=True, stands_in=False)


def save_some(robot: str | None, connect: Sequence[str], names: Sequence[str], *, as_json: bool) -> int:
    """Save `names`, which are fields or whole services, or everything; return the exit code."""
    if bare := [name for name in names if "." not in name and name not in _TABLES]:
        return show(robot, connect, bare, values, as_json=as_json)  # which tells what was meant

    def report(connection: RobotConnection) -> int:
        services = _services(connection, names)
        fields: dict[str, tuple[str, ...]] = dict.fromkeys(services, ())
        for service, dot, field in (name.partition(".") for name in names):
            if dot and service not in names:
                fields[service] += (field,)
        by = user_at_host()
        requests = {service: ParamSave(names=few, by=by) for service, few in fields.items()}
        return _told(_ask(connection, PARAM_SAVE, requests, _SAVE_PATIENCE), services, as_json=as_json)

    return run_with_robot(robot, connect, report, moves=True, stands_in=False)


def _told(answers: Answers, services: set[str], *, as_json: bool) -> int:
    """Say what became of a request; the exit code."""
    for service in sorted(services - answers.keys()):
        print_error(f"NOT CONFIRMED: {_silent({service})}")
    for answer in answers.values():
        if not answer.done:
            print_error(str(answer.reason))
    done = [Shown(answer.service, answer.host, param) for answer in answers.values() for param in answer.params]
    if as_json:
        print_json([answer for _, answer in sorted(answers.items())])
    elif done:
        print("\n".join(printable(one.sentence()) for one in done))
    if len(answers) < len(services) or all(answer.mistyped for answer in answers.values()):
        return UNUSABLE
    return _DONE if all(answer.done for answer in answers.values()) else _WRONG


def _services(connection: RobotConnection, names: Iterable[str]) -> set[str]:
    """Those that `names` are of and that are there, all where none is named. Raises NoRobotError."""
    wanted = {name.partition(".")[0] for name in names} - {"robot"}
    there: set[str] = set()
    deadline, settled = time.monotonic() + _PATIENCE, 0.0
    while time.monotonic() < deadline:
        there |= {token.service for token in find_tokens(connection.session, alive_key(connection.robot), _PATIENCE)}
        there &= ANSWERING
        settled = settled or (time.monotonic() + _SETTLED if there else 0.0)
        if wanted and wanted <= there:
            break
        if settled and time.monotonic() > settled and not wanted & _TABLES:
            break
        time.sleep(_TURN)
    if not there:
        raise NoRobotError(not_found_text(connection.robot, list_robots(connection.session)))
    if away := sorted(wanted - there):
        raise NoRobotError(
            f"{away[0]}: no such service is heard of {connection.robot}; {meant(away[0], there)}"
            f"there are {', '.join(sorted(there))}"
        )
    return wanted or there


def _ask(
    connection: RobotConnection, query: Query[Any, ParamAnswer], requests: dict[str, Any], patience: float
) -> Answers:
    """The answers of those who answered within `patience`, s. Each is asked again until it does."""
    waiting = {
        service: QueryClient(connection.session, connection.robot, query.at(require_chunk(service)), request)
        for service, request in sorted(requests.items())
    }
    answers: Answers = {}
    deadline = time.monotonic() + patience
    while len(answers) < len(waiting) and (now := time.monotonic()) < deadline:
        for service, asking in waiting.items():
            if service not in answers and (answer := asking.poll(now)) is not None:
                answers[service] = answer
        time.sleep(_TURN)
    return answers


def _value(text: str) -> Any:
    """Return the value that was typed: of JSON, or else text. ValueError: no message can hold it."""
    if text.lower() in ("none", "null"):
        return None
    try:
        value = msgspec.json.decode(text)
    except msgspec.ValidationError as error:
        raise ValueError(plain(error)) from error
    except (msgspec.DecodeError, UnicodeEncodeError, RecursionError):
        return text
    require_sendable(value)
    return value


def _silent(services: set[str]) -> str:
    which = ", ".join(sorted(services))
    return f"{which} did not answer; on a secured network [network.access] says who may ask, else restart it"


def _unknown(name: str, shown: Sequence[Shown]) -> str:
    """Return what is wrong with a name that is no parameter's, and what was meant, as far as one can tell."""
    fields: dict[str, list[str]] = {}
    for table, _, field in sorted({one.name.partition(".") for one in shown}):
        fields.setdefault(table, []).append(field)
    table, dot, field = name.partition(".")
    owners = [each for each in fields if name in fields[each]]
    if owners:
        return f"{name}: name the service too, like {' or '.join(f'{each}.{name}' for each in owners[:_MOST])}"
    if dot:
        close = [f"{each}.{found}" for each in near(table, fields) for found in near(field, fields[each])]
    else:
        close = near(name, fields) or [f"{each}.{found}" for each in fields for found in near(name, fields[each])]
    hint = f"did you mean {' or '.join(close[:_MOST])}? " if close else ""
    if table not in fields:
        return f"{name}: no such parameter; {hint}there are {', '.join(fields)}, and giraff param list has all of each"
    return f"{name}: no such parameter; {hint}{table} has {', '.join(fields[table])}"
