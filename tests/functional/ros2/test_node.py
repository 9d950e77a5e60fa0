"""The robot's node on a ROS network, met by bare Zenoh sessions that say what rmw_zenoh_cpp says."""

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from types import SimpleNamespace

import pytest
import zenoh
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__String as String

from giraff_node.network.session import close_session
from giraff_ros2.config import Ros2Config
from giraff_ros2.port import Received, Refused
from giraff_ros2.rmw import node as rmw_node
from giraff_ros2.rmw import session
from giraff_ros2.rmw.definitions import Definitions
from giraff_ros2.rmw.names import Attachment, Entity, dds_type, gid_of, key_of, qos_text
from giraff_ros2.rmw.node import RosNode
from giraff_ros2.topics import CMD_VEL, ESTOP, ESTOP_ENGAGED, ODOM, ROBOT_DESCRIPTION, RosTopic

DEFINITIONS = Definitions("kilted")
DRIVE = DEFINITIONS.encode(Twist(Vector3(0.25, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)), CMD_VEL.type)
WITHIN = 10.0  # s; a busy machine
BLOCK = zenoh.CongestionControl.BLOCK


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def until(seen: Callable[[], object]) -> None:
    end = time.monotonic() + WITHIN
    while not seen():
        assert time.monotonic() < end
        time.sleep(0.01)


def take(node: RosNode, heard: list[Received | Refused]) -> int:
    """Add what has come; return how many there are."""
    heard += node.pop_all()
    return len(heard)


def answer(node: RosNode) -> int:
    """Answer each call that has come; return how many there were."""
    calls = [*node.calls()]
    for call in calls:
        call.answer(True, "stopped")
    return len(calls)


class Stranger:
    """A process of ROS, as its session says it."""

    def __init__(self, port: int, mode: str = "peer") -> None:
        config = zenoh.Config()
        for key, value in {
            "mode": f'"{mode}"',
            "connect/endpoints": f'["tcp/127.0.0.1:{port}"]',
            "listen/endpoints": '["tcp/127.0.0.1:0"]' if mode == "peer" else "[]",
            "scouting/multicast/enabled": "false",
            "timestamping/enabled": "true",
            "adminspace/enabled": "true",
        }.items():
            config.insert_json5(key, value)
        self.session = zenoh.open(config)

    def token(self, kind: str, topic: RosTopic, type_hash: str = "") -> tuple[zenoh.LivelinessToken, bytes]:
        type_hash = type_hash or DEFINITIONS.hash_of(topic.type)
        entity = Entity(str(self.session.zid()), 0, 1, kind, "/", "teleop", f"/{topic.name}")
        entity = entity._replace(type=dds_type(topic.type), type_hash=type_hash, qos=qos_text(topic.qos))
        return self.session.liveliness().declare_token(entity.token(0)), gid_of(entity.token(0))

    def close(self) -> None:
        close_session(self.session)


def key(topic: RosTopic) -> str:
    name = topic.name.replace("~", "giraff")
    return key_of(0, name, topic.type, DEFINITIONS.hash_of(topic.type))


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
def node(port: int) -> Iterator[RosNode]:
    made = RosNode(Ros2Config(router=f"127.0.0.1:{port}"), (ODOM, ROBOT_DESCRIPTION, ESTOP_ENGAGED))
    with closing(made):
        yield made


def test_it_is_the_router_where_there_is_none_and_a_peer_where_there_is_one(port: int, node: RosNode) -> None:
    assert node.way.is_router
    with closing(RosNode(Ros2Config(router=f"127.0.0.1:{port}", namespace="r2"), (ODOM,))) as second:
        assert not second.way.is_router
        assert not second.trouble()


def test_its_router_passes_on_what_is_of_ros_and_nothing_of_giraff(port: int, node: RosNode) -> None:
    assert node.way.is_router
    heard: list[str] = []

    def on_sample(sample: zenoh.Sample) -> None:
        heard.append(str(sample.key_expr))

    with closing(Stranger(port, "client")) as one, closing(Stranger(port, "client")) as other:
        keys = ("giraff/r/odom", "giraff/r/cmd_vel/keyboard", "giraff/r/camera/head/@full", "0/odom/type/hash")
        _kept = [other.session.declare_subscriber(key, on_sample) for key in ("**", *keys)]
        _token = one.session.liveliness().declare_token("giraff/r/alive/base/1")

        def say() -> bool:
            for key in keys:
                one.session.put(key, b"")
            return len(heard) > 5

        until(say)
        assert set(heard) == {"0/odom/type/hash"}
        assert not list(other.session.liveliness().get("giraff/**", timeout=1.0))


def test_another_port_is_taken_where_no_router_listens(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "OTHER_PORT", other := free_port())
    with (
        socket.create_server(("127.0.0.1", port)),
        closing(RosNode(Ros2Config(router=f"127.0.0.1:{port}"), ())) as node,
    ):
        assert node.way.is_router
        assert node.way.port == other
        with closing(RosNode(Ros2Config(router=f"127.0.0.1:{port}"), ())) as second:
            assert (second.way.port, second.way.is_router) == (other, False)


def test_who_publishes_is_known_heard_and_asked(port: int, node: RosNode) -> None:
    with closing(Stranger(port)) as stranger:
        _token, gid = stranger.token("MP", CMD_VEL)
        until(lambda: list(node.publishers()))
        (publisher,) = node.publishers()
        assert (publisher.node, publisher.gid) == ("/teleop", gid)
        before = time.monotonic()
        until(lambda: list(node.publishers()) and node.answers(publisher.process).newest > before)
        heard: list[Received | Refused] = []
        sent = Attachment(1, time.time_ns(), gid)
        for payload, attachment in [
            (DRIVE, sent.encode()),
            (DRIVE, b""),
            (DRIVE[:-1], sent.encode()),
            (bytes(100_000), sent.encode()),
        ]:
            # On a busy machine Zenoh drops a message of two batches after 1 ms, unless it may wait.
            stranger.session.put(key(CMD_VEL), payload, attachment=attachment, congestion_control=BLOCK)
        until(lambda: take(node, heard) == 4)
        first, *refused = heard
        assert isinstance(first, Received)
        assert (first.message.linear.x, first.gid, first.sent_ns) == (0.25, gid, sent.sent_ns)
        assert all(isinstance(each, Refused) and "/cmd_vel was refused" in str(each.trouble) for each in refused)
        assert "attachment" in str(refused[0])
    until(lambda: not list(node.publishers()))


def test_an_answer_proves_that_a_process_was_awake_when_it_was_asked_and_not_later(
    port: int, node: RosNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [1e6]  # s
    monkeypatch.setattr(rmw_node, "time", SimpleNamespace(monotonic=lambda: clock[0], time_ns=time.time_ns))
    with closing(Stranger(port)) as stranger:
        _token, _gid = stranger.token("MP", CMD_VEL)
        until(lambda: node._graph.publishers)
        (publisher,) = node.publishers()
        clock[0] = 2e6
        until(lambda: node.answers(publisher.process).newest > 0.0)
        assert node.answers(publisher.process).newest == 1e6


def test_a_publisher_of_another_hash_is_named_and_not_heard(port: int, node: RosNode) -> None:
    with closing(Stranger(port)) as stranger:
        _token, gid = stranger.token("MP", CMD_VEL, "TypeHashNotSupported")
        until(node.trouble)
        assert "/teleop publishes /cmd_vel" in str(node.trouble())
        attachment = Attachment(1, time.time_ns(), gid).encode()
        stranger.session.put(key_of(0, "/cmd_vel", CMD_VEL.type, "TypeHashNotSupported"), DRIVE, attachment=attachment)
        _right, gid = stranger.token("MP", CMD_VEL)
        stranger.session.put(key(CMD_VEL), DRIVE, attachment=Attachment(1, 7, gid).encode())
        heard: list[Received | Refused] = []
        until(lambda: take(node, heard))
        (only,) = heard
        assert isinstance(only, Received)
        assert only.sent_ns == 7


def test_a_latched_text_is_read_late_and_a_subscriber_is_seen(port: int, node: RosNode) -> None:
    node.publish(ROBOT_DESCRIPTION, String("<robot/>"))
    node.publish(ROBOT_DESCRIPTION, String("<robot name='r'/>"))
    with closing(Stranger(port)) as stranger:
        read: list[str] = []

        def on_sample(sample: zenoh.Sample) -> None:
            read.append(DEFINITIONS.decode(bytes(sample.payload), ROBOT_DESCRIPTION.type).data)

        _late = zenoh.ext.declare_advanced_subscriber(
            stranger.session,
            key(ROBOT_DESCRIPTION),
            on_sample,
            history=zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
        )
        assert not node.is_wanted(ODOM)
        _token, _ = stranger.token("MS", ODOM)
        until(lambda: node.is_wanted(ODOM))
        until(lambda: read)
        assert read == ["<robot name='r'/>"]


def test_a_call_is_answered_with_its_own_number(port: int, node: RosNode) -> None:
    with closing(Stranger(port)) as stranger:
        everything = stranger.session.get(
            "0/**",
            attachment=Attachment(1, 1, bytes(16)).encode(),
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=1.0,
        )
        assert not list(everything)
        assert not list(node.calls())  # a wildcard asks everybody, and calls nobody
        asked = Attachment(41, 1, bytes(range(16)))
        replies = stranger.session.get(
            key(ESTOP), payload=b"\0\1\0\0\0", attachment=asked.encode(), target=zenoh.QueryTarget.ALL_COMPLETE
        )
        until(lambda: answer(node))
        (reply,) = replies
        assert reply.ok is not None
        assert bytes(reply.ok.payload) == DEFINITIONS.trigger_response(success=True, message="stopped")
        back = bytes(reply.ok.attachment or b"")
        assert (back[:8], back[17:]) == (asked.encode()[:8], asked.gid)
