"""What a sample costs: it is encoded once, and its numbers are checked where it is made and where it arrives."""

from collections import Counter
from functools import partial
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

from giraff_node import node
from giraff_node.node import Publisher
from giraff_schemas import checks, codec, messages
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.topics import WHEELS, key_of


def test_a_sample_is_encoded_once_and_checked_once_at_each_end(monkeypatch: pytest.MonkeyPatch) -> None:
    counts: Counter[str] = Counter()

    def counted(name: str, whole: Any, *given: Any) -> Any:
        counts[name] += 1
        return whole(*given)

    monkeypatch.setattr(messages, "require_finite", partial(counted, "numbers", checks.require_finite))
    monkeypatch.setattr(messages, "require_moment", partial(counted, "moments", checks.require_moment))
    monkeypatch.setattr(node, "encode", partial(counted, "encoded", codec.encode))
    sent: list[bytes] = []
    session: Any = SimpleNamespace(declare_publisher=lambda *_, **__: SimpleNamespace(put=sent.append))
    publisher = Publisher(session, "alpha", WHEELS, "someone")

    names = ("left_ticks", "right_ticks", "left_velocity", "right_velocity", "left_pwm_counts", "right_pwm_counts")
    numbers: dict[str, Any] = dict.fromkeys(names, 1)
    sample = Wheels(**numbers, board_us=1, boot_id=1, tick=RobotTime(1, 1))
    made = {"numbers": 1, "moments": 1}
    assert counts == made
    publisher.put(sample)
    assert counts == {**made, "encoded": 1}
    counts.clear()
    heard = codec.decode(WHEELS, key_of("alpha", WHEELS), sent[0], codec.encoding_of(Wheels))
    assert counts == made
    assert msgspec.structs.replace(heard, stamp_ns=0, instance="") == sample
