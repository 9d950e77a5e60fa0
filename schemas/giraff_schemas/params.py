"""What is asked and answered of a service's parameters: the fields of its configuration."""

from typing import Any, Literal

import msgspec

from giraff_schemas.trouble import NO_TROUBLE, Trouble

LiveText = Literal["up", "down", "free", "checked", "fixed"]


class Param(msgspec.Struct, frozen=True, kw_only=True):
    """One field of a service's configuration. Values are what JSON has: a tuple is a list."""

    name: str
    """Field of the service's own table; `robot.<field>` of the table that services share."""
    value: Any
    """In force now."""
    filed: Any
    """What the robot file says, with the environment and defaults."""
    saved: bool
    """The value in force comes again after a restart."""
    kind: str
    """Its type, in words."""
    live: LiveText
    """What may be done to it now: `up` and `down` bear on safety, and only that way from `filed`; `checked`: until the
    service ends; `fixed`: nothing."""
    doc: str
    """Unit, and what it is for."""


class ParamDescribe(msgspec.Struct, frozen=True, kw_only=True):
    """Asks a service for all its parameters."""


class ParamSet(msgspec.Struct, frozen=True, kw_only=True):
    """Asks a service to go by another value from now on, until it ends."""

    name: str
    value: Any
    by: str


class ParamSave(msgspec.Struct, frozen=True, kw_only=True):
    """Asks a service to keep over restarts what is in force now, of these parameters; of all where none is named."""

    names: tuple[str, ...] = ()
    by: str


class ParamAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """What a service says to each of them."""

    service: str
    instance: str
    host: str
    done: bool
    """What was asked is so now."""
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""
    params: tuple[Param, ...]
    """Those it is about, as they are now."""
    mistyped: bool = False
    """There is no such parameter, or it cannot have such a value: nothing was tried."""
