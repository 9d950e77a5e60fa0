"""What rmw_zenoh_cpp says: texts as a real ROS 2 (Kilted, rmw_zenoh_cpp 0.6.7) wrote them, and what is none."""

from types import SimpleNamespace
from typing import Any

import pytest
import xxhash
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3

from giraff_ros2.port import RosPublisher
from giraff_ros2.rmw.definitions import Definitions, TornError
from giraff_ros2.rmw.graph import Graph
from giraff_ros2.rmw.names import Attachment, Entity, attachment_of, entity_of, gid_of, key_of, qos_text
from giraff_ros2.rmw.node import sample_attachment
from giraff_ros2.topics import CMD_VEL, CMD_VEL_STAMPED, ESTOP, LATCHED, PUBLISHED, SENSOR, SUBSCRIBED, Qos

TWIST_HASH = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
TOKEN = f"@ros2_lv/0/abc1/0/3/MP/%/%r1/teleop/%r1%cmd_vel/geometry_msgs::msg::dds_::Twist_/{TWIST_HASH}/::,10:,:,:,,"
KILTED = Definitions("kilted")
DRIVE = Twist(Vector3(0.25, 0.0, 0.0), Vector3(0.0, 0.0, -0.5))


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (Qos(), "::,10:,:,:,,"),
        (SENSOR, "2::,5:,:,:,,"),
        (LATCHED, ":1:,1:,:,:,,"),
        (Qos(depth=42), "::,:,:,:,,"),
    ],
)
def test_qos_is_written_as_ros_writes_it(qos: Qos, text: str) -> None:
    assert qos_text(qos) == text


def test_key_and_token_are_those_of_ros() -> None:
    entity = entity_of(TOKEN)
    assert entity == Entity(
        "abc1",
        0,
        3,
        "MP",
        "/r1",
        "teleop",
        "/r1/cmd_vel",
        "geometry_msgs::msg::dds_::Twist_",
        TWIST_HASH,
        "::,10:,:,:,,",
    )
    assert entity.token(0) == TOKEN
    assert entity.full_node == "/r1/teleop"
    assert (
        key_of(0, "/r1/cmd_vel", CMD_VEL.type, TWIST_HASH)
        == f"0/r1/cmd_vel/geometry_msgs::msg::dds_::Twist_/{TWIST_HASH}"
    )
    node = Entity("abc1", 0, 0, "NN", "/", "giraff")
    assert node.token(7) == "@ros2_lv/7/abc1/0/0/NN/%/%/giraff"
    assert entity_of(node.token(7)) == node
    assert entity_of(f"{TOKEN}/backends:cpu") == entity  # of Lyrical


@pytest.mark.parametrize(
    "token",
    [
        "",
        "@ros2_lv/0/abc1",
        TOKEN.replace("/3/", "/x/"),
        TOKEN.replace("abc1", "**"),
        TOKEN.replace("/teleop/", "//"),
        f"{TOKEN}/a/b",
        TOKEN[1:],
    ],
)
def test_another_token_is_nobody(token: str) -> None:
    assert entity_of(token) is None


def test_attachment_has_33_bytes_little_endian() -> None:
    attachment = Attachment(1, 2, bytes(range(16)))
    assert attachment.encode() == b"\1" + bytes(7) + b"\2" + bytes(7) + b"\x10" + bytes(range(16))
    assert attachment_of(attachment.encode()) == attachment
    for wrong in (
        b"",
        attachment.encode()[:-1],
        attachment.encode() + b"\0",
        attachment.encode().replace(b"\x10", b"\x0f", 1),
    ):
        assert attachment_of(wrong) is None
    assert gid_of("giraff") == xxhash.xxh3_128_digest(b"giraff")[::-1]  # its canonical form is big-endian


def test_a_sample_without_an_attachment_or_of_too_many_bytes_is_refused() -> None:
    attachment = Attachment(1, 2, bytes(range(16)))

    def sample(size: int, attached: bytes | None) -> Any:
        return SimpleNamespace(payload=bytes(size), attachment=attached)

    assert sample_attachment(sample(4096, attachment.encode())) == attachment
    for attached in (None, b"", attachment.encode()[:-1]):
        with pytest.raises(TornError, match="no attachment"):
            sample_attachment(sample(52, attached))
    with pytest.raises(TornError, match="4097 bytes"):
        sample_attachment(sample(4097, attachment.encode()))


def test_hashes_are_those_of_ros_and_humble_has_none() -> None:
    assert KILTED.hash_of(CMD_VEL.type) == Definitions("jazzy").hash_of(CMD_VEL.type) == TWIST_HASH
    assert Definitions("humble").hash_of(CMD_VEL.type) == "TypeHashNotSupported"
    assert KILTED.hash_of(ESTOP.type).startswith("RIHS01_eeff2cd6")
    assert all(KILTED.hash_of(topic.type).startswith("RIHS01_") for topic in (*PUBLISHED, *SUBSCRIBED))


@pytest.mark.parametrize("distribution", ["humble", "jazzy", "kilted"])
def test_a_message_comes_back_whole_or_not_at_all(distribution: str) -> None:
    definitions = Definitions(distribution)  # type: ignore[arg-type]
    data = definitions.encode(DRIVE, CMD_VEL.type)
    back = definitions.decode(data, CMD_VEL.type)
    assert (back.linear.x, back.angular.z) == (0.25, -0.5)
    for cut in range(len(data)):
        with pytest.raises(TornError, match="geometry_msgs/msg/Twist"):
            definitions.decode(data[:cut], CMD_VEL.type)
    with pytest.raises(TornError, match="of 56 bytes"):
        definitions.decode(data + bytes(4), CMD_VEL.type)
    with pytest.raises(TornError):
        definitions.decode(data, CMD_VEL_STAMPED.type)


def test_answer_of_a_trigger_is_that_of_ros() -> None:
    assert KILTED.trigger_response(success=True, message="ok") == b"\0\1\0\0\1\0\0\0\3\0\0\0ok\0"


def test_graph_tells_who_speaks_who_listens_and_who_is_not_heard() -> None:
    graph = Graph("me", {CMD_VEL: ("/r1/cmd_vel", TWIST_HASH)}, {"/r1/odom"})
    for number in range(600):  # a large system beside it
        graph.on_token(TOKEN.replace("/MP/", "/MS/").replace("cmd_vel", f"other{number}"), is_there=True)
    graph.on_token(TOKEN, is_there=True)
    graph.on_token(TOKEN.replace("abc1", "me"), is_there=True)
    publisher = RosPublisher(gid_of(TOKEN), "/r1/teleop", "abc1", CMD_VEL)
    assert graph.publishers == (publisher,)
    assert not graph.trouble
    wrong = TOKEN.replace("abc1", "def2").replace(TWIST_HASH, "TypeHashNotSupported")
    graph.on_token(wrong, is_there=True)
    assert graph.publishers == (publisher,)
    assert "/r1/teleop publishes /r1/cmd_vel" in str(graph.trouble)
    graph.on_token(wrong, is_there=False)
    assert not graph.trouble
    watcher = TOKEN.replace("/MP/", "/MS/").replace("%r1%cmd_vel", "%r1%odom")
    graph.on_token(watcher, is_there=True)
    assert graph.wanted == {"/r1/odom"}
    graph.on_token(TOKEN, is_there=False)
    graph.on_token(watcher, is_there=False)
    assert not graph.publishers + tuple(graph.wanted)


def test_a_hostile_name_is_shown_as_plain_text_and_not_at_length() -> None:
    graph = Graph("me", {CMD_VEL: ("/r1/cmd_vel", TWIST_HASH)})
    graph.on_token(TOKEN.replace("teleop", "\x1b[2Jx" + "y" * 5000), is_there=True)
    (publisher,) = graph.publishers
    assert "\x1b" not in publisher.node
    assert len(publisher.node) < 100


def test_a_flood_of_tokens_is_bounded() -> None:
    graph = Graph("me", {CMD_VEL: ("/r1/cmd_vel", TWIST_HASH)})
    for number in range(600):
        graph.on_token(TOKEN.replace("abc1", f"{number:x}"), is_there=True)
    assert len(graph.publishers) == 500
    assert "not all are known" in str(graph.trouble)
