"""Trouble: what is wrong, and what to do about it. People read both as one line, and programs read each by itself."""

import msgspec

from giraff_schemas.actions import ANY, Action, ActionWords


class Trouble(msgspec.Struct, frozen=True):
    """False where nothing is wrong."""

    what: str = ""
    """Fault or condition, with its likely cause."""
    remedy: str = ""
    """Remedy, the same on each screen. Empty: nobody knows one, or `action` says it."""
    action: Action = ""
    """Last step of the remedy, which each screen says in its own words."""
    argument: str = ""
    """Time that the hand is held, command to run, or command to run before a release. For `ask` and `take` it is the
    operator that drives; empty: none drives."""

    def __bool__(self) -> bool:
        return bool(self.what)

    def __str__(self) -> str:
        return self.line(ANY)

    def line(self, words: ActionWords) -> str:
        """Return what is wrong and what to do about it, in the words of one screen."""
        return "; ".join(filter(None, (self.what, self.to_do(words))))

    def to_do(self, words: ActionWords) -> str:
        """Return remedy and action, in the words of one screen; empty: nobody knows what to do."""
        steps = [self.remedy]
        if self.argument and self.action in {"run", "release"}:
            steps.append(words["run"].format(self.argument))
        if self.action and self.action != "run":
            steps.append(words[self.action].format(self.argument or "a moment"))
        return ", then ".join(filter(None, steps))

    def of(self, whom: str) -> "Trouble":
        """Return the same trouble, with the name of the part that has it before it."""
        return msgspec.structs.replace(self, what=f"{whom}: {self.what}")


NO_TROUBLE = Trouble()
