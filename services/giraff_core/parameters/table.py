"""The parameters of one service: what they are, and what may be done to them while it runs. No I/O.

A safety value can only be tightened, and a tightening can be taken back as far as the robot file goes: what the robot
file says is what somebody answers for. Whatever was saved counts after a restart only where it is no looser than that.
The fields of an inner table of several kinds are parameters of their own: `drive.k1`.
"""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, Final, Generic, TypeVar

import msgspec

from giraff_core.robot import RobotConfig
from giraff_core.tuning import Tuning, live_fields, loosens
from giraff_schemas.checks import converted
from giraff_schemas.fields import fields_of
from giraff_schemas.params import Param
from giraff_schemas.text import near

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)
"""The table of a service."""

_SHARED: Final = "robot."


class ParamError(Exception):
    """A parameter is not set. The message names the rule, and the way out."""


class MistypedError(ParamError):
    """There is no such parameter, or it cannot have such a value. Nothing that the service goes by decides that."""


class Parameters(Generic[ConfigT]):
    """`filed`: the service's table as the robot file and the environment have it; `service`: its name."""

    def __init__(self, service: str, filed: ConfigT, robot: RobotConfig) -> None:
        self.config = filed
        """What is in force."""
        self.saved: dict[str, Any] = {}
        """What is kept over restarts, by field."""
        self.unknown: tuple[str, ...] = ()
        """Names of saved values that no parameter has any more."""
        self._service = service
        self._filed = filed
        # Read from their source now: the turn that answers a question is one that stops motors, too.
        self._documented = {**_described(type(filed)), **_described(type(robot), _SHARED)}
        self._live: dict[str, Tuning] = {}
        for name, tuning in live_fields(type(filed)).items():
            if not _is_told_apart(value := getattr(filed, name)):
                self._live[name] = tuning or Tuning.READ_ONLY
                continue
            kind: type[msgspec.Struct] = type(value)
            self._live |= {f"{name}.{field}": its or Tuning.READ_ONLY for field, its in live_fields(kind).items()}
            self._documented |= _described(kind, f"{name}.")
        self._robot = robot

    def restore(self, saved: Mapping[str, Any]) -> list[str]:
        """Put in force what was saved, as far as it may be; what of it is not, and why."""
        self.unknown = tuple(saved.keys() - self._live.keys() - self._documented.keys())
        never = [self._never_saved(name) for name in saved if self._live.get(name) is Tuning.CHECKED]
        saved = {name: value for name, value in saved.items() if self._live.get(name) is not Tuning.CHECKED}
        try:
            self.config, self.saved = self._changed(self._filed, saved), saved
        except ParamError:
            return never + self._restore_each(saved)
        return never

    def value(self, name: str) -> Any:
        """Return the value of a parameter that is in force."""
        return _at(self.config, name)

    @property
    def unsaved(self) -> tuple[str, ...]:
        """Names of those that nobody can save and that differ from the robot file."""
        checked = (name for name, live in self._live.items() if live is Tuning.CHECKED)
        return tuple(name for name in checked if _at(self.config, name) != _at(self._filed, name))

    def set(self, name: str, value: Any) -> None:
        """Put another value in force. Raises ParamError."""
        self.config = self._changed(self.config, {name: value})

    def to_save(self, names: Iterable[str]) -> dict[str, Any]:
        """What is kept once these are saved, all where none is named: what the robot file says is not.

        Raises ParamError, also where it would not count after a restart.
        """
        wanted = set(names)
        for name in wanted:
            if name not in self._live:
                raise self._unknown(name)
            if self._live[name] is Tuning.CHECKED:
                raise ParamError(self._never_saved(name))
        now, filed = self._values(self.config), self._values(self._filed)
        lasting = [name for name in now if self._live[name] is not Tuning.CHECKED]
        after = {name: now[name] if name in (wanted or now) else self.saved.get(name, filed[name]) for name in lasting}
        kept = {name: value for name, value in after.items() if value != filed[name]}
        try:
            self._changed(self._filed, kept)
        except ParamError as error:
            raise ParamError(f"after a restart it would not count: {error}; save all of {self._service}") from error
        return kept

    def describe(self, names: Iterable[str] = ()) -> tuple[Param, ...]:
        """As they are now; all of them where none is named."""
        now, filed, shared = self._values(self.config), self._values(self._filed), _plain(self._robot)
        own = [
            self._described(name, now[name], filed[name], saved=self.saved.get(name, filed[name]) == now[name])
            for name in self._live
        ]
        own += [self._described(_SHARED + name, value, value, saved=True) for name, value in shared.items()]
        wanted = set(names)
        return tuple(param for param in own if not wanted or param.name in wanted)

    def _changed(self, config: ConfigT, values: Mapping[str, Any]) -> ConfigT:
        """With all of these at once. Raises ParamError."""
        for name in values:
            full = f"{self._service}.{name}"
            if name not in self._live:
                raise self._unknown(name)
            if self._live[name] is Tuning.READ_ONLY:
                raise ParamError(f"{full} cannot change while the service runs: it takes the robot file and a restart")
        plain = _plain(config)
        for name, value in values.items():
            table, dot, field = name.rpartition(".")
            (plain[table] if dot else plain)[field] = value
        try:
            changed = converted(plain, type(config), strict=False)
        except ValueError as error:
            told = ", ".join(f"{self._service}.{name} {value}" for name, value in values.items())
            raise MistypedError(f"{told}: {error}") from error
        for name in values:
            live, before, after = self._live[name], _at(self._filed, name), _at(changed, name)
            if live not in (Tuning.FREE, Tuning.CHECKED) and loosens(live, before, after):
                raise ParamError(
                    f"{self._service}.{name} {_shown(after)} is looser than {_shown(before)}: "
                    "loosening takes the robot file, standstill and a restart"
                )
        return changed

    def _restore_each(self, saved: Mapping[str, Any]) -> list[str]:
        """Those that may be, whatever their order; why the others are not."""
        ignored: dict[str, str] = {}
        for name, value in saved.items():
            try:
                self.set(name, value)
            except ParamError as error:
                ignored[name] = str(error)
            else:
                self.saved[name] = value
        if not ignored or len(ignored) == len(saved):
            return [*ignored.values()]
        return self._restore_each({name: saved[name] for name in ignored})

    def _values(self, config: ConfigT) -> dict[str, Any]:
        """By parameter, what JSON has."""
        plain = _plain(config)
        return {
            name: plain[table][field] if dot else plain[name]
            for name in self._live
            for table, dot, field in (name.rpartition("."),)
        }

    def _never_saved(self, name: str) -> str:
        return f"{self._service}.{name} is never saved: after a restart the robot file counts again, so write it there"

    def _described(self, name: str, value: Any, filed: Any, *, saved: bool) -> Param:
        kind, doc = self._documented[name]
        live = self._live.get(name, Tuning.READ_ONLY)
        return Param(name=name, value=value, filed=filed, saved=saved, kind=kind, live=live.value, doc=doc)

    def _unknown(self, name: str) -> ParamError:
        if name in self._documented:
            who = "shared by all services" if name.startswith(_SHARED) else "fixed"
            return ParamError(f"{name} is {who}: it takes the robot file and a restart")
        close = near(name, self._live)
        hint = f"did you mean {self._service}.{close[0]}?" if close else f"there are: {', '.join(self._live)}"
        return MistypedError(f"{self._service} has no parameter {name}; {hint}")


def _plain(config: msgspec.Struct) -> dict[str, Any]:
    """By field, what JSON has."""
    plain: dict[str, Any] = msgspec.to_builtins(config)
    return plain


def _at(config: msgspec.Struct, name: str) -> Any:
    """Return the value of `margin`, or of `drive.k1` within its table."""
    found: Any = config
    for field in name.split("."):
        found = getattr(found, field)
    return found


def _is_told_apart(value: Any) -> bool:
    """Whether a field holds a table of one of several kinds. Each field of that is a parameter."""
    return isinstance(value, msgspec.Struct) and value.__struct_config__.tag is not None


def _shown(value: Any) -> str:
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


@cache
def _described(config: type[msgspec.Struct], prefix: str = "") -> dict[str, tuple[str, str]]:
    """By field with its prefix: its type in words, and what its docstring says."""
    return {prefix + field.name: (field.type, field.doc) for field in fields_of(config)}
