"""Who may do what through a router, and what it is believed: real links, certificates and rules."""

from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from giraff_schemas.topics import ESTOP_ENGAGE, ESTOP_RESET, ODOM, TICK, TILT, Topic, alive_key, key_of
from giraff_setup.keys.manage import make_authority, make_bundle
from tests.support.behind_router import BehindRouter
from tests.support.fleet import (
    ANNE,
    AWAY,
    BOB,
    DOCTOR,
    EVERY,
    HOME,
    JOYSTICK,
    NO_RULES,
    PLACES,
    SEVERAL,
    Fleet,
    Heard,
    fleet,
)
from tests.support.process_robot import PATIENCE
from tests.support.sites import ROUTER, Sites
from tests.support.waiting import wait


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fleet]:
    with fleet(tmp_path_factory.mktemp("fleet")) as made:
        yield made


def keys_of(robot: str, *topics: Topic[Any]) -> set[str]:
    return {f"{robot}/{topic.key}" for topic in topics}


def test_no_packet_of_one_site_reaches_another(world: Fleet) -> None:
    """Else the rest of this file would show nothing."""
    assert not world.behind.reaches(AWAY, HOME)
    assert world.behind.reaches(AWAY, ROUTER)


@pytest.mark.parametrize("sessions", ["of", "lawless"])
def test_an_operator_commands_its_robot_by_its_own_name(world: Fleet, sessions: str) -> None:
    heard = world.say_everything(getattr(world, sessions)["laptop"], "laptop")
    assert heard == {"anne": keys_of(ANNE, JOYSTICK, TILT), "bob": set()}


def test_two_robots_of_one_operator_never_hear_each_others_commands(world: Fleet) -> None:
    heard = world.say_everything(world.lawless["doctor"], "doctor")
    assert heard == {"anne": keys_of(ANNE, DOCTOR, TILT), "bob": keys_of(BOB, DOCTOR, TILT)}


@pytest.mark.parametrize("host", ["desk", "unnamed"])
def test_nobody_else_commands(world: Fleet, host: str) -> None:
    assert world.say_everything(world.lawless[host], host) == {"anne": set(), "bob": set()}


def test_no_robot_commands_another(world: Fleet) -> None:
    assert world.say_everything(world.lawless["bob-pc"], "bob")["anne"] == set()


@pytest.mark.parametrize(("host", "hears"), [("laptop", True), ("desk", True), ("unnamed", False), ("bob-pc", False)])
def test_whoever_is_named_reads(world: Fleet, host: str, hears: bool) -> None:
    sessions = (world.of[host], world.lawless[host])
    for session in sessions:
        session.ask("heard")
    robot, heard = world.of["anne-pc"], {session: list[tuple[str, str]]() for session in sessions}
    robot.ask("put", "here", key_of(ANNE, ODOM))
    world.mark(robot, [key_of(ANNE, TICK)], sessions if hears else [world.of["laptop"]], heard)
    if host == "bob-pc":
        world.mark(world.lawless["doctor"], [key_of(BOB, DOCTOR)], sessions, heard)
    elif not hears:
        for session in sessions:
            world.answers(session)
    for session in sessions:
        heard[session] += [(key, said) for key, said in session.ask("heard")]
        found = [key for key, said in heard[session] if said == "here"]
        assert found == ([key_of(ANNE, ODOM)] if hears else [])


@pytest.mark.parametrize(
    ("host", "stops", "resets"),
    [("laptop", True, True), ("desk", True, False), ("unnamed", False, False), ("bob-pc", False, False)],
)
def test_whoever_is_named_may_stop_and_operators_reset(world: Fleet, host: str, stops: bool, resets: bool) -> None:
    asks = world.lawless[host]
    assert asks.ask("get", key_of(ANNE, ESTOP_ENGAGE)) == (["done"] if stops else [])
    assert asks.ask("get", key_of(ANNE, ESTOP_RESET)) == (["done"] if resets else [])


@pytest.mark.parametrize("host", ["desk", "anne-pc"])
def test_each_side_sees_who_is_on_the_other_and_nobody_poses_as_the_robot(world: Fleet, host: str) -> None:
    seen: set[str] = set()

    def all_there() -> bool:
        seen.update(world.of[host].ask("alive", alive_key(ANNE)))  # to one question Zenoh may pass on a part of it
        return len(seen) >= 2

    wait(all_there, PATIENCE)
    assert seen == {alive_key(ANNE, "base", "one"), alive_key(ANNE, "joystick", "one")}


def test_the_router_says_who_is_here_and_who_may_do_nothing(world: Fleet) -> None:
    said = world.behind.router_log.read_text
    told = [f"{host} is here, from tls/{world.behind.address(site)}" for host, (site, _) in PLACES.items()]
    told.append("unnamed: has a certificate, but no part in any [router.robots]")
    # Links are looked at now and then, and the test may come before the next look.
    wait(lambda: all(each in said() for each in told), PATIENCE, what=said)


def require_a_link_of_one_who_came_later(world: Fleet) -> None:
    """All dial as often as it has."""
    later = world.behind.join("desk", AWAY, ANNE)
    wait(lambda: any(link.startswith(ROUTER) for link in later.ask("links")), PATIENCE)


def test_a_site_that_is_not_the_routers_gets_no_link(world: Fleet) -> None:
    path = world.behind.robot_file("laptop", AWAY, ANNE)
    path.write_text(path.read_text().replace(f'site = "{AWAY}"', 'site = "nowhere"'))
    elsewhere = world.behind.open(AWAY, path, ANNE)
    require_a_link_of_one_who_came_later(world)
    assert not [link for link in elsewhere.ask("links") if link.startswith(ROUTER)]


def test_a_stranger_gets_no_link(world: Fleet, tmp_path: Path) -> None:
    """A bundle of another authority, with the names of this one's."""
    others, now = tmp_path / "keys", datetime.now(UTC)
    make_authority(others, now)
    make_bundle(others, "laptop", [world.behind.address(AWAY)], days=30, renew=False, moment=now)
    path = world.behind.robot_file("laptop", AWAY, ANNE)
    path.write_text(path.read_text().replace(str(world.behind.keys), str(others)))
    stranger = world.behind.open(AWAY, path, ANNE, **NO_RULES)
    require_a_link_of_one_who_came_later(world)
    assert stranger.ask("links") == []
    assert world.say_everything(stranger, "stranger") == {"anne": set(), "bob": set()}


def test_without_certificates_it_passes_on_all_from_private_addresses(tmp_path: Path) -> None:
    with Sites(HOME, AWAY) as sites, closing(BehindRouter(tmp_path, sites, (HOME, AWAY), {})) as behind:
        behind.start_router()
        robot, anybody = behind.join("robot", HOME, ANNE), behind.join("anybody", AWAY, ANNE)
        robot.ask("subscribe", key_of(ANNE, JOYSTICK))

        def commanded() -> bool:
            anybody.ask("put", "forward", key_of(ANNE, JOYSTICK))
            return bool(robot.ask("heard"))

        wait(commanded, PATIENCE)


def test_what_has_become_of_the_router_does_not_matter_to_base(world: Fleet) -> None:
    """Whoever has its certificate can be an operator, and nothing more: no word of the robot's own hosts."""
    world.behind.kill_router()
    rogue = world.behind.rogue_router()
    robot = world.of["anne-pc"]
    wait(lambda: any(link.startswith("anne-pc") for link in rogue.ask("links")), PATIENCE)
    world.mark(rogue, [key_of(ANNE, JOYSTICK)], [robot])
    rogue.ask("put", "rogue", *(key_of(ANNE, topic) for topic in EVERY))
    rogue.ask("put", "rogue", *(several.format(ANNE) for several in SEVERAL))
    heard: Heard = {robot: []}
    world.mark(rogue, [key_of(ANNE, JOYSTICK)], [robot], heard)
    assert {key.removeprefix("giraff/") for key, said in heard[robot] if said == "rogue"} == keys_of(
        ANNE, JOYSTICK, DOCTOR, TILT
    )
