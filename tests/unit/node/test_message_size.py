"""How large a message each kind of session takes: whatever is larger would be put together in its memory."""

import json
from pathlib import Path
from typing import Any, Final, Literal

import msgspec
import pytest
import zenoh

from giraff_core.access import AccessConfig
from giraff_core.network import NetworkConfig
from giraff_node.network.session import CERTIFICATES, session_config
from giraff_router.config import RouterConfig
from giraff_router.main import router_config
from giraff_schemas.codec import encode
from giraff_schemas.topics import TOPICS, Topic
from tests.support.secured_hosts import ACCESS, ROBOT
from tests.unit.schemas.samples import an_example

OURS: Final = 64 * 1024
RECORDED: Final = 16 * 1024 * 1024
ZENOHS: Final = 1024 * 1024 * 1024

MODES = ("lan", "fixed", "secured")


@pytest.fixture
def keys(tmp_path: Path) -> str:
    """A bundle in which nobody looks."""
    for name in CERTIFICATES.values():
        (tmp_path / name).write_text("")
    return str(tmp_path)


def taken(config: dict[str, Any]) -> int:
    """bytes of the largest message that Zenoh takes when it is told this."""
    told: dict[str, int] = json.loads(zenoh.Config.from_json5(json.dumps(config)).get_json("transport/link/rx"))
    return told["max_message_size"]


@pytest.mark.parametrize(
    ("kind", "size"),
    [
        ({"role": "door"}, OURS),
        ({"role": "client"}, OURS),
        ({"records": True, "role": "outside"}, RECORDED),
        ({"records": True, "role": "client"}, RECORDED),
    ],
    ids=["service", "command", "flight recorder", "giraff record"],
)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("local", [False, True])
def test_a_session_takes_what_it_is_there_for(
    kind: dict[str, Any], size: int, mode: str, local: bool, keys: str
) -> None:
    network = msgspec.convert(
        {"mode": mode, "local": local, "keys": keys, "access": msgspec.to_builtins(ACCESS)}, NetworkConfig
    )
    assert taken(session_config(network, ROBOT, **kind)) == size


@pytest.mark.parametrize(("mode", "robots"), [("fixed", {}), ("secured", {ROBOT: ACCESS})])
def test_a_router_passes_on_what_is_there(
    mode: Literal["fixed", "secured"], robots: dict[str, AccessConfig], keys: str
) -> None:
    router = RouterConfig(mode=mode, robots=robots, keys=keys, listen=("127.0.0.1:7447",), sites=("home", "away"))
    assert taken(router_config(router)) == ZENOHS


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.key)
def test_no_sample_comes_near(topic: Topic[Any]) -> None:
    sample = msgspec.convert(an_example(topic.schema), topic.schema)
    assert len(encode(sample)) < OURS // 10
