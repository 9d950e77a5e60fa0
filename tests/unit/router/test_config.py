"""A router that would let anybody drive does not start, and says how it would."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_router.config import RouterConfig
from giraff_router.main import router_config
from giraff_router.policy import rules
from giraff_setup.keys.manage import make_authority, make_bundle

ANNE = {"robot": ["anne-pc"], "operators": {"laptop": ["joystick"]}}
SECURED: dict[str, Any] = {"sites": ["home", "away"], "robots": {"anne": ANNE}}
OPEN: dict[str, Any] = {"sites": ["home", "away"], "mode": "fixed"}


def refused(table: dict[str, Any]) -> str:
    with pytest.raises(msgspec.ValidationError) as raised:
        msgspec.convert(table, RouterConfig)
    return str(raised.value)


def test_certificates_are_asked_for_unless_it_is_said_that_none_are() -> None:
    assert msgspec.convert(SECURED, RouterConfig).mode == "secured"


@pytest.mark.parametrize(
    "listen", [["0.0.0.0:7447"], ["[::]:7447"], ["8.8.8.8:7447"], ["192.168.1.5:7447", "[2a00:1450:4001::1]:7447"]]
)
def test_without_certificates_it_does_not_listen_where_the_internet_may_be(listen: list[str]) -> None:
    said = refused(OPEN | {"listen": listen})
    assert "may be reached from the internet" in said
    assert 'set mode to "secured"' in said


def test_without_certificates_it_must_be_told_where_to_listen() -> None:
    assert "0.0.0.0:7447 may be reached from the internet" in refused(OPEN)


@pytest.mark.parametrize("address", ["192.168.1.5:7447", "10.8.0.1:7447", "100.64.0.3:7447", "[fd00::5]:7447"])
def test_without_certificates_it_listens_at_private_addresses(address: str) -> None:
    assert msgspec.convert(OPEN | {"listen": [address]}, RouterConfig).listen == (address,)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"sites": ["home"]}, "name two or more"),
        ({"sites": ["home", "home"]}, "each once"),
        ({"sites": ["home", ""]}, "site ''"),
        ({"sites": ["home", "x" * 33]}, "1 to 32 letters"),
        ({"listen": []}, "give one ADDRESS:PORT at least"),
        ({"listen": ["router.example.org:7447"]}, "numbers only"),
        ({"listen": ["192.168.1.5"]}, "no ADDRESS:PORT"),
        ({"listen": ["192.168.1.5:0"]}, "no ADDRESS:PORT"),
        ({"listen": ["::1:7447"]}, "no ADDRESS:PORT"),
        ({"robots": {}}, "nobody may do anything"),
        ({"robots": {"an/ne": ANNE}}, "cannot be part of a key"),
        ({"robots": {"anne": {"viewers": ["desk"]}}}, r"[router.robots.anne] names no host of the robot"),
        ({"robots": {"anne": ANNE | {"viewers": ["laptop"]}}}, "laptop: one host has one certificate"),
        ({"mode": "lan"}, "Invalid enum value 'lan'"),
        ({"mode": "fixed", "listen": ["10.0.0.1:7447"]}, "the rules in [router.robots] would not hold"),
        ({"site": "home"}, "unknown field `site`"),
    ],
)
def test_what_cannot_be_meant_is_refused(changes: dict[str, Any], complaint: str) -> None:
    assert complaint in refused(SECURED | changes)


def test_it_keeps_to_the_rules_where_it_has_certificates(tmp_path: Path) -> None:
    keys, now = tmp_path / "keys", datetime.now(UTC)
    make_authority(keys, now)
    make_bundle(keys, "router", ["192.0.2.1"], days=30, renew=False, moment=now)
    router = msgspec.convert(SECURED | {"keys": str(keys / "router")}, RouterConfig)
    control = router_config(router)["access_control"]
    assert (control["enabled"], control["default_permission"]) == (True, "deny")
    assert control == control | rules(router.robots)
    assert control["policies"]
