"""Parameters as people and programs read them."""

from collections.abc import Iterable, Sequence
from typing import Any, Final, NamedTuple

from giraff_schemas.params import Param
from giraff_schemas.text import printable
from giraff_tools.terminal.page import print_table, print_wrapped

_SHARED: Final = "robot."
_MAY: Final = {
    "up": "safety: may be raised live",
    "down": "safety: may be lowered live",
    "free": "may change live",
    "checked": "may change live, until a restart",
    "fixed": "robot file and restart",
}
_LIVE: Final = {"up": "raise only", "down": "lower only", "free": "yes", "checked": "until restart", "fixed": "no"}
"""The same in a column."""
_NOT_SAVED: Final = "NOT SAVED, until the service ends"


class Shown(NamedTuple):
    """One parameter of one service."""

    service: str
    host: str
    param: Param

    @property
    def is_shared(self) -> bool:
        """Of the table [robot], which all services go by."""
        return self.param.name.startswith(_SHARED)

    @property
    def name(self) -> str:
        """As people call it: guard.margin, robot.track_width."""
        return self.param.name if self.is_shared else f"{self.service}.{self.param.name}"

    def is_meant(self, name: str) -> bool:
        """Tell whether a name is this parameter's, or that of a table it is in."""
        return f"{self.name}.".startswith(f"{name}.")

    def sentence(self) -> str:
        """Where its value stands now."""
        param = self.param
        state = _state(param)
        return f"{self.name} {text(param.value)}{f' ({state})' if state else ''}"


def listed(shown: Sequence[Shown]) -> None:
    """Print one line each: name, what may be done to it, value, and where that is not the robot file's."""
    print_table(
        ("parameter", "live", "value"),
        [
            (one.name, _LIVE[one.param.live], f"{text(one.param.value)}{state and f' ({state})'}")
            for one in _once(shown)
            for state in (_state(one.param),)
        ],
    )


def values(shown: Sequence[Shown]) -> None:
    """Print the value alone of one parameter; of a whole table, names and values."""
    one, *others = _once(shown)
    if others:
        listed(shown)
    else:
        print(printable(text(one.param.value)))


def described(shown: Sequence[Shown]) -> None:
    """Print some lines each."""
    for one in _once(shown):
        print_wrapped(printable(f"{one.name} = {text(one.param.value)}"))
        for line in filter(None, _lines(one.param)):
            print_wrapped(f"    {printable(line)}")


def as_objects(shown: Iterable[Shown]) -> list[dict[str, Any]]:
    """For programs: every service's, also of what they share."""
    return [
        {
            "name": one.name,
            "service": one.service,
            "host": one.host,
            "value": one.param.value,
            "robot_file": one.param.filed,
            "saved": one.param.saved,
            "type": one.param.kind,
            "live": one.param.live,
            "doc": one.param.doc,
        }
        for one in shown
    ]


def differing(shown: Iterable[Shown]) -> list[str]:
    """Of what services should share: a word for each that they do not."""
    by_name: dict[str, list[Shown]] = {}
    for one in shown:
        if one.is_shared:
            by_name.setdefault(one.name, []).append(one)
    return [
        f"{name} differs: {', '.join(f'{text(one.param.value)} in {one.service} on {one.host}' for one in ones)}; "
        "give all hosts the same robot file, and restart"
        for name, ones in by_name.items()
        if any(one.param.value != ones[0].param.value for one in ones)
    ]


def text(value: Any) -> str:
    """As in the robot file; `none` for no value."""
    match value:
        case None:
            return "none"
        case bool():
            return str(value).lower()
        case float():
            return f"{value:g}"
        case str():
            return value
        case dict():
            return "{" + ", ".join(f"{name}: {text(field)}" for name, field in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(text, value)) + "]"
        case _:
            return str(value)


def _state(param: Param) -> str:
    if param.value != param.filed:
        unsaved = "until the service restarts, and never saved" if param.live == "checked" else _NOT_SAVED
        return f"robot file: {text(param.filed)}; {'saved' if param.saved else unsaved}"
    return "" if param.saved else "NOT SAVED: another value was, and comes again after a restart"


def _lines(param: Param) -> tuple[str, ...]:
    return (param.doc, f"{param.kind}; {_MAY[param.live]}", _state(param))


def _once(shown: Iterable[Shown]) -> list[Shown]:
    """What services share is shown once for each value."""
    found: dict[tuple[str, str], Shown] = {}
    for one in shown:
        found.setdefault((one.name, text(one.param.value)), one)
    return sorted(found.values(), key=lambda one: (one.is_shared, one.service if not one.is_shared else ""))
