"""Trouble: what is wrong, and what to do about it. People read both as one line, and programs read each by itself."""

from __future__ import annotations

import msgspec

from giraff_schemas.actions import ANY, Action, Words


class Trouble(msgspec.Struct, frozen=True):
    """False where nothing is wrong."""

    what: str = ""
    """What is wrong, with its likely cause."""
    remedy: str = ""
    """What to do about it, on each screen alike; empty: nobody knows, or `action` says it."""
    action: Action = ""
    """What to do after the remedy."""
    argument: str = ""
    """How long the hand is held, the command to run, or the one to run before a release. Who drives, where the action
    is `ask` or `take`; empty: nobody does."""

    def __bool__(self) -> bool:
        return bool(self.what)

    def __str__(self) -> str:
        return self.line(ANY)

    def line(self, words: Words) -> str:
        """Return what is wrong and what to do about it, in the words of one screen."""
        return "; ".join(filter(None, (self.what, self.to_do(words))))

    def to_do(self, words: Words) -> str:
        """Return remedy and action, in the words of one screen; empty: nobody knows what to do."""
        steps = [self.remedy]
        if self.argument and self.action in {"run", "release"}:
            steps.append(words["run"].format(self.argument))
        if self.action and self.action != "run":
            steps.append(words[self.action].format(self.argument or "a moment"))
        return ", then ".join(filter(None, steps))

    def of(self, whom: str) -> Trouble:
        """The same, after the name of what has it."""
        return msgspec.structs.replace(self, what=f"{whom}: {self.what}")


NO_TROUBLE = Trouble()
