"""Payloads that cannot be read are named once a key, for a few keys, whatever comes."""

import tracemalloc

from giraff_node.network.subscription import MOST, DecodeErrors
from giraff_schemas.trouble import Trouble

PATTERN = "giraff/sim-test/range/*"


class Log:
    """What a node would state and log."""

    def __init__(self) -> None:
        self.lines = 0
        self.faults: dict[str, str] = {}

    def set_fault(self, name: str, trouble: Trouble) -> None:
        message = str(trouble)
        if self.faults.get(name, "") == message:
            return
        self.lines += 1
        self.faults[name] = message
        if not message:
            del self.faults[name]


def test_a_key_is_named_once_until_it_is_mended() -> None:
    log = Log()
    keys = DecodeErrors(PATTERN, log.set_fault)
    for number in range(100):
        keys.bad("a", Trouble(f"fault {number}"), 0.1 * number)
        keys.good("a", 0.1 * number)
    assert log.faults == {"decode a": "fault 0"}
    keys.good("a", 9.9 + 2.1)
    assert log.faults == {}
    keys.bad("a", Trouble("again"), 13.0)
    assert log.faults == {"decode a": "again"}


def test_floods_of_bad_payloads_on_invented_keys_fill_neither_memory_nor_log() -> None:
    log = Log()
    keys = DecodeErrors(PATTERN, log.set_fault)
    for number in range(1000):
        keys.bad(f"key {number}", Trouble("x" * 10_000), 0.0)
    tracemalloc.start()
    for number in range(1_000, 60_000):
        keys.bad(f"key {number}", Trouble("not MessagePack"), 0.0)
    kept, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept < 10_000
    assert len(log.faults) == MOST + 1
    assert log.lines == MOST + 1
    assert sum(map(len, log.faults.values())) < 10_000


def test_room_is_made_when_a_key_is_mended() -> None:
    log = Log()
    keys = DecodeErrors(PATTERN, log.set_fault)
    for number in range(MOST + 1):
        keys.bad(f"key {number}", Trouble("bad"), 0.0)
    assert f"more than {MOST} keys" in log.faults[f"decode more of {PATTERN}"]
    keys.good("key 0", 3.0)
    assert len(log.faults) == MOST - 1
    keys.bad("key 99", Trouble("bad"), 3.0)
    assert log.faults["decode key 99"] == "bad"
