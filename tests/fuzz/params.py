"""The parameters of a robot that is shouted at: what may be asked of them, and that none has become looser."""

from collections.abc import Iterable

import msgspec

from giraff_schemas.codec import encode
from giraff_schemas.params import Param, ParamSave, ParamSet
from giraff_schemas.topics import PARAM_DESCRIBE, PARAM_QUERIES, PARAM_SAVE, PARAM_SET
from giraff_sim.settings import MACHINES

PARAM_KEYS = tuple(query.at(service) for query in PARAM_QUERIES for service in MACHINES)
BY = "fuzz"
Truths = dict[str, list[bytes]]
"""By key: requests that mean something, to be mutated."""


def truths_of(service: str, params: Iterable[Param]) -> Truths:
    """What may be asked of a service and changes nothing, as it stands."""
    return {
        PARAM_DESCRIBE.at(service).key: [msgspec.msgpack.encode({"by": BY})],  # a word too many, to be mutated
        PARAM_SET.at(service).key: [encode(ParamSet(name=param.name, value=param.value, by=BY)) for param in params],
        PARAM_SAVE.at(service).key: [encode(ParamSave(names=(param.name,), by=BY)) for param in params],
    }


def changes(filed: Iterable[Param], now: Iterable[Param]) -> list[tuple[Param, Param]]:
    """Of those that have another value now: as the robot file has it, and as it is."""
    both = list(zip(filed, now, strict=True))
    assert all(before.name == after.name for before, after in both)
    return [(before, after) for before, after in both if after.value != before.value]


def require_no_looser(before: Param, now: Param) -> None:
    """What a parameter is `now` is allowed, if it was `before`."""
    match now.live:
        case "up":
            assert now.value > before.value, now
        case "down":
            assert now.value is None or before.value is None or now.value < before.value, now
        case "fixed":
            raise AssertionError(f"{now} cannot change")
        case "free":
            pass
