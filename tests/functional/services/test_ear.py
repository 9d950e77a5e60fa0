"""What a recorder hears, on a session that hears itself."""

from collections.abc import Iterator

import pytest
import zenoh

from giraff_mcap import raw_subscriber as ear
from giraff_mcap.raw_subscriber import RawSubscriber
from giraff_node.network.session import close_session


@pytest.fixture
def session() -> Iterator[zenoh.Session]:
    config = zenoh.Config()
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", "[]")
    opened = zenoh.open(config)
    yield opened
    close_session(opened)


def test_each_sample_comes_with_its_key_its_bytes_and_its_encoding(session: zenoh.Session) -> None:
    hears = RawSubscriber(session, ["giraff/anna/**"])
    for number in range(3):
        session.put("giraff/anna/odom", bytes([number]), encoding="application/msgpack")
        session.put("giraff/anna/own", b"x", encoding="text/plain")
    session.put("giraff/berta/odom", b"another robot's")
    session.put("giraff/anna/empty", b"")
    session.delete("giraff/anna/own")
    taken = hears.pop_all()
    assert [(one.key, one.payload, one.encoding) for one in taken if one.key.endswith("odom")] == [
        ("giraff/anna/odom", bytes([number]), "application/msgpack") for number in range(3)
    ]
    assert {(one.payload, one.encoding) for one in taken if one.key.endswith("own")} == {(b"x", "text/plain")}
    assert len(taken) == 7, "what is empty is a sample as well, and a deletion is none"
    assert [one.at_ns for one in taken] == sorted(one.at_ns for one in taken)
    session.put("giraff/anna/odom", b"later", encoding="application/msgpack")
    session.put("giraff/anna/own", b"{}", encoding="application/json")
    assert [(one.payload, one.encoding) for one in hears.pop_all()] == [
        (b"later", "application/msgpack"),
        (b"{}", "application/json"),
    ]
    hears.close()
    session.put("giraff/anna/odom", b"to nobody")
    assert (hears.pop_all(), hears.overrun) == ([], 0)


def test_what_cannot_wait_is_counted(session: zenoh.Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ear, "_MOST_WAITING", 5)
    hears = RawSubscriber(session, ["giraff/anna/**"])
    for number in range(8):
        session.put("giraff/anna/odom", bytes([number]) * 2)
    assert hears.overrun == 3
    assert [one.payload[0] for one in hears.pop_all()] == [3, 4, 5, 6, 7]
    assert hears.overrun == 3
    hears.close()
