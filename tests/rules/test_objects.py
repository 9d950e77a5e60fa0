"""No object of the boards' C needs a symbol of one that needs its own, not even by way of others."""

import re
from itertools import chain
from typing import Final

from giraff_schemas.boards import ALL_BOARDS
from giraff_sim.board import BUILD, newer_source
from tests.support.tools import finished

Needs = dict[str, dict[str, list[str]]]
"""Of each object: the others that it needs, and which symbols of theirs."""

BOARDS: Final = [board.name for board in ALL_BOARDS]
PROGRAMS: Final = [f"{board.name}" if board.is_process else f"{board.name}.elf" for board in ALL_BOARDS]
LINKED: Final = ("lockstep/lockstep.so", *(f"firmware/{p}" for p in PROGRAMS), *(f"host/{b}.so" for b in BOARDS))
FROM_INTERRUPTS: Final = re.compile(r"\w+_on_\w+|gathered")
"""What the processor's side needs of the program above it: hal.h has that interrupts call it. Ardros's fill what is
`gathered` by themselves, since a call would take them too long."""


def needs_of(listing: str) -> Needs:
    """By what nm tells of the objects of all that is linked, each in the folder of what it is linked to."""
    symbols = re.findall(r"^((?:lockstep|\w+/\w+)/)(\S+)\.o: (\S+) (\w)", listing, re.MULTILINE)
    home = {(linked, symbol): each for linked, each, symbol, kind in symbols if kind not in "Uvw"}
    needs: Needs = {}
    for linked, each, symbol, kind in symbols:
        other = home.get((linked, symbol), each)
        goes_up = other.startswith("program/") and not each.startswith("program/") and FROM_INTERRUPTS.fullmatch(symbol)
        if kind in "Uvw" and other != each and not goes_up:
            needs.setdefault(linked + each, {}).setdefault(linked + other, []).append(symbol)
    return needs


def circles(needs: Needs) -> list[str]:
    """A line for whatever the objects of a circle need of each other."""
    reached = {each: _reached(each, needs) for each in needs}
    return [
        f"{each} needs {', '.join(symbols)} of {other}"
        for each in sorted(needs)
        for other, symbols in sorted(needs[each].items())
        if each in reached.get(other, ())
    ]


def _reached(begin: str, needs: Needs) -> set[str]:
    found: set[str] = set()
    ahead = [begin]
    while ahead:
        new = needs.get(ahead.pop(), {}).keys() - found
        found |= new
        ahead += new
    return found


def test_no_object_needs_one_that_needs_it() -> None:
    old = [each for each in LINKED if newer_source(BUILD / each) is not None]
    assert not old, f"run make setup: sources have changed since these were built: {old}"
    notes = [(BUILD / each).with_suffix(".sources").read_text() for each in LINKED]
    objects = [re.findall(r"^\S+/build/(\S+\.o):", note, re.MULTILINE) for note in notes]
    assert all(objects)
    command = ["nm", "--print-file-name", "--portability", "--extern-only", *chain(*objects)]
    listing = finished(command, cwd=BUILD, check=True).stdout
    assert not (found := circles(needs_of(listing))), "\n".join(found)


def test_a_circle_is_told_with_its_objects_and_their_symbols() -> None:
    """An interrupt's call makes none, and what only leads to a circle is not in it."""
    listing = """
host/base/program/base.o: uart_send U
host/base/program/uart.o: uart_send T 0 1
host/base/program/uart.o: uart_on_receive T 0 1
host/base/program/uart.o: hal_transmit U
host/base/machine/processor.o: hal_transmit T 0 1
host/base/machine/processor.o: uart_on_receive U
host/base/machine/processor.o: machine_now_ns U
host/base/machine/machine.o: machine_now_ns T 0 1
"""
    assert circles(needs_of(listing)) == []
    assert circles(needs_of(f"{listing}host/base/machine/machine.o: uart_send U\n")) == [
        "host/base/machine/machine needs uart_send of host/base/program/uart",
        "host/base/machine/processor needs machine_now_ns of host/base/machine/machine",
        "host/base/program/uart needs hal_transmit of host/base/machine/processor",
    ]
