"""What may arrive on a key: samples that were true once, mutated, and everything that is none."""

import random
from collections.abc import Callable, Sequence
from typing import Any, Final

import msgspec

_encode = msgspec.msgpack.Encoder().encode

NUMBERS: Final = (
    float("nan"),
    float("inf"),
    float("-inf"),
    -0.0,
    5e-324,
    1.7e308,
    0,
    -1,
    1 << 31,
    (1 << 64) - 1,
    -(1 << 63),
)
OTHERS: Final[tuple[Any, ...]] = (
    *(None, True, False, "", "hand", "\0", "é" * 300, b"\0\xff"),
    *([], {}, [[]], {"a": {}}, {1: 2}),
)
_HUGE: Final = 1 << 16
_DEEP: Final = 5000
_NESTING: Final = (b"\x91", b"\x81\xa1a", b"\xdd\0\0\0\1", b"\xdc\xff\xff", b"\x82\xa3seq")


def _flipped(payload: bytes, chance: random.Random) -> bytes:
    changed = bytearray(payload)
    for _ in range(chance.choice((1, 1, 1, 2, 8))):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)


def _cut(payload: bytes, chance: random.Random) -> bytes:
    return payload[: chance.randrange(len(payload))]


def _spliced(payload: bytes, chance: random.Random) -> bytes:
    at, to = sorted((chance.randrange(len(payload)), chance.randrange(len(payload))))
    return payload[:at] + chance.choice((payload[at:to] * 2, b"", chance.randbytes(9))) + payload[to:]


def _random(_payload: bytes, chance: random.Random) -> bytes:
    return chance.randbytes(chance.choice((0, 1, 3, 20, 200)))


def _nested(_payload: bytes, chance: random.Random) -> bytes:
    return chance.choice(_NESTING) * chance.choice((10, 500, _DEEP))


def _huge(payload: bytes, chance: random.Random) -> bytes:
    """A field that claims, or has, far more than it may."""
    values = msgspec.msgpack.decode(payload)
    name = chance.choice(list(values))
    return _encode(values | {name: chance.choice(("x" * _HUGE, [0] * _HUGE, 10.0**300, {"": "y" * _HUGE}))})


def _respelt(payload: bytes, chance: random.Random) -> bytes:
    """A map as it should be, but for a value, a field too few or one too many."""
    values = msgspec.msgpack.decode(payload)
    name = chance.choice(list(values))
    match chance.randrange(6):
        case 0:
            del values[name]
        case 1:
            values[chance.choice(("", "linear", name + "_"))] = chance.choice(OTHERS)
        case 2 | 3:
            values[name] = chance.choice(NUMBERS)
        case 4:
            values[name] = chance.choice(OTHERS)
        case _:
            inner = values[name]
            if isinstance(inner, dict) and inner:
                values[name] = inner | {chance.choice(list(inner)): chance.choice((*NUMBERS, *OTHERS))}
    return _encode(values)


def _true(payload: bytes, _chance: random.Random) -> bytes:
    return payload


_KINDS: Final[tuple[tuple[Callable[[bytes, random.Random], bytes], int], ...]] = (
    (_flipped, 40),
    (_respelt, 30),
    (_true, 8),
    (_cut, 8),
    (_spliced, 7),
    (_random, 6),
    (_nested, 1),
)
_HUGE_ONE_IN: Final = 2000


def payload(truths: Sequence[bytes], chance: random.Random) -> bytes:
    """One more payload. `truths`: encoded maps that were sent once."""
    truth = chance.choice(truths)
    if chance.randrange(_HUGE_ONE_IN) == 0:
        return _huge(truth, chance)
    [kind] = chance.choices([kind for kind, _ in _KINDS], [weight for _, weight in _KINDS])
    return kind(truth, chance)
