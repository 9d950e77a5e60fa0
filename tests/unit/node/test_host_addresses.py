"""Where this host is found, and when it is to be found elsewhere."""

import ipaddress

import pytest

from giraff_node.network.host_addresses import AddressWatch, host_addresses

NONE: frozenset[str] = frozenset()
HOME = frozenset({"192.168.1.20"})
OTHER = frozenset({"10.0.0.7"})


def moves(told: frozenset[str], *seen: frozenset[str], every: bool = False) -> list[bool]:
    watch = AddressWatch(told, every=every)
    return [watch.moved(float(second), addresses) for second, addresses in enumerate(seen)]


@pytest.mark.parametrize(
    ("told", "seen", "moved"),
    [
        (NONE, (NONE, NONE, NONE), [False, False, False]),
        (NONE, (HOME, HOME), [False, True]),
        (NONE, (HOME, NONE, HOME), [False, False, False]),
        (HOME, (HOME, NONE, NONE, HOME, HOME), [False] * 5),
        (HOME, (HOME | OTHER, HOME | OTHER), [False, False]),
        (HOME, (OTHER, OTHER), [False, True]),
        (HOME | OTHER, (OTHER, OTHER), [False, False]),
    ],
    ids=["alone", "network comes", "link flaps", "cable cut and mended", "one more", "new address", "one less"],
)
def test_moved(told: frozenset[str], seen: tuple[frozenset[str], ...], moved: list[bool]) -> None:
    assert moves(told, *seen) == moved


@pytest.mark.parametrize(
    ("told", "seen", "moved"),
    [
        (HOME, (HOME, HOME), [False, False]),
        (HOME, (HOME | OTHER, HOME | OTHER), [False, True]),
        (HOME | OTHER, (HOME, HOME), [False, True]),
        (HOME, (HOME | OTHER, HOME, HOME | OTHER), [False, False, False]),
        (HOME, (NONE, NONE, NONE), [False, False, False]),
        (HOME, (NONE, OTHER, HOME | OTHER, HOME | OTHER), [False, False, False, True]),
    ],
    ids=["as told", "one more", "one less", "a VPN flaps", "alone", "one after the other"],
)
def test_a_door_counts_each_address(told: frozenset[str], seen: tuple[frozenset[str], ...], moved: list[bool]) -> None:
    assert moves(told, *seen, every=True) == moved


def test_looked_at_once_a_second() -> None:
    watch = AddressWatch(NONE)
    assert watch.due(5.0)
    watch.moved(5.0, NONE)
    assert not watch.due(5.9)
    assert watch.due(6.0)


def test_the_loopback_is_no_address_for_others() -> None:
    assert not any(ipaddress.ip_address(address).is_loopback for address in host_addresses())
