"""The little of udev that the rules use: read strictly, and applied to a device."""

import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Final

_TERM: Final = re.compile(r'(?P<key>[A-Z]+)(\{(?P<name>[A-Z_]+)\})?(?P<operator>==|!=|\+=|=)"(?P<value>[^"]*)"')
_OPERATORS: Final = {
    "ACTION": {"==", "!="},
    "SUBSYSTEM": {"==", "!="},
    "ENV": {"==", "!=", "="},
    "SYMLINK": {"+="},
    "GROUP": {"="},
    "MODE": {"="},
    "GOTO": {"="},
    "LABEL": {"="},
}
_NAMED: Final = {"ENV"}


class RuleError(ValueError):
    """A line that udev would not take, or not as it is meant."""


@dataclass(frozen=True)
class Term:
    key: str
    name: str
    operator: str
    value: str


@dataclass
class Device:
    """What is known of a port, and what the rules make of it."""

    properties: dict[str, str]
    action: str = "add"
    subsystem: str = "tty"
    links: list[str] = field(default_factory=list)
    group: str = ""
    mode: str = ""

    def holds(self, term: Term) -> bool:
        known = {"ACTION": self.action, "SUBSYSTEM": self.subsystem, "ENV": self.properties.get(term.name, "")}
        matches = any(fnmatchcase(known[term.key], pattern) for pattern in term.value.split("|"))
        return matches is (term.operator == "==")

    def take(self, term: Term) -> None:
        match term.key:
            case "SYMLINK":
                self.links.append(term.value)
            case "GROUP":
                self.group = term.value
            case "MODE":
                self.mode = term.value
            case "ENV":
                self.properties[term.name] = term.value


def parse(line: str) -> list[Term]:
    """The terms of one rule. Raises RuleError."""
    terms = []
    for text in re.split(r",\s+", line):
        found = _TERM.fullmatch(text)
        if found is None:
            raise RuleError(f"not a term: {text}")
        term = Term(found["key"], found["name"] or "", found["operator"], found["value"])
        if term.operator not in _OPERATORS.get(term.key, set()):
            raise RuleError(f"{term.key} does not take {term.operator}")
        if bool(term.name) is not (term.key in _NAMED):
            raise RuleError(f"{term.key} with, or without, a name in braces: {text}")
        terms.append(term)
    return terms


def rules(text: str) -> list[list[Term]]:
    """The rules of a file. Raises RuleError, also where a GOTO leads nowhere further down."""
    read = [parse(line.strip()) for line in text.splitlines() if line.strip() and not line.startswith("#")]
    for number, rule in enumerate(read):
        below = {term.value for later in read[number:] for term in later if term.key == "LABEL"}
        for term in rule:
            if term.key == "GOTO" and term.value not in below:
                raise RuleError(f"no LABEL {term.value} below its GOTO")
    return read


def apply(read: list[list[Term]], device: Device) -> Device:
    """The device as the rules leave it."""
    skipping_to = ""
    for rule in read:
        if skipping_to:
            if any(term.key == "LABEL" and term.value == skipping_to for term in rule):
                skipping_to = ""
            continue
        if all(device.holds(term) for term in rule if term.operator in ("==", "!=")):
            for term in rule:
                if term.operator not in ("==", "!="):
                    device.take(term)
            skipping_to = next((term.value for term in rule if term.key == "GOTO"), "")
    return device
