"""What many commands say of a robot that none of them changes: called beside each other, for the tests to judge."""

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from tests.support.desk import Desk, Done, is_well, run_beside

Holds = Callable[[Done], object]
Scene = Callable[[Desk], Done]


def answers(desk: Desk, asked: Mapping[str, Holds], scenes: Mapping[str, Scene]) -> dict[str, Done]:
    """By its words each command of `asked`, once what it says holds; by its name what each scene made."""

    def answer(name: str) -> Done:
        return scenes[name](desk) if name in scenes else desk.until(asked[name], *name.split())

    return run_beside(answer, [*scenes, *asked])


def at_once(_: Done) -> bool:
    """The first answer is the one."""
    return True


def in_json(holds: Callable[[Any], object]) -> Holds:
    """Of the one document that a command with --json prints when all is well."""
    return lambda done: is_well(done) and holds(msgspec.json.decode(done.stdout))


def document(done: Done) -> Any:
    """That document."""
    assert is_well(done), done
    return msgspec.json.decode(done.stdout)
