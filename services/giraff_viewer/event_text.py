"""What guard and base say, in words: a page for now, and a line of the log for each change."""

import re
from typing import Final

from giraff_schemas.localization import MapPose
from giraff_schemas.messages import BaseState, Clearance, DirectionLimit, EStop, GuardState, Lease, Sample
from giraff_schemas.trouble import Trouble

Line = tuple[str, str]
"""Level (INFO, WARN or ERROR) and text."""

_NUMBER: Final = re.compile(r"\d+")
_BLOCKS: Final = (range(0x20, 0x7F), range(0xA0, 0x149), range(0x14A, 0x17F), range(0x391, 0x3CA), range(0x410, 0x450))
ALPHABET: Final = tuple(chr(number) for block in _BLOCKS for number in block if chr(number).isprintable())
"""Latin with its accents, Greek and Cyrillic letters.

The viewer's headless form ends at a character for which its font has no glyph."""
_DRAWN: Final = frozenset(ALPHABET)


def drawable(text: str) -> str:
    """Return text of the network on one line, with a question mark for each character that has no glyph."""
    return "".join(character if character in _DRAWN else "?" for character in text)


class EventText:
    """The newest of each, and what was told of it already."""

    def __init__(self) -> None:
        self._guard: GuardState | None = None
        self._base: BaseState | None = None
        self._estop: EStop | None = None
        self._lease: Lease | None = None
        self._place = ""
        self._told: dict[str, Line] = {}

    def on_sample(self, sample: Sample) -> list[Line]:
        """What has changed with it."""
        match sample:
            case GuardState():
                self._guard = sample
                return self._changes(_of_guard(sample))
            case BaseState():
                self._base = sample
                return self._changes(_of_base(sample))
            case EStop():
                self._estop = sample
                return self._changes({"e-stop": _of_estop(sample)})
            case Lease():
                self._lease = sample
                holder = sample.operator or "nobody"
                return self._changes({"lease": ("INFO", f"{holder} drives{_because(sample.reason)}")})
            case MapPose():
                level, self._place = _of_place(sample)
                return self._changes({"map": (level, self._place)})
            case _:
                return []

    def add(self, subject: str, line: Line) -> list[Line]:
        """The same of anything else."""
        return self._changes({subject: line})

    @property
    def page(self) -> str:
        """As of now, in Markdown."""
        parts = []
        if self._estop is not None and self._estop.engaged:
            parts += ["# EMERGENCY STOP", f"{self._estop.by}: {self._estop.reason}"]
        if self._base is not None:
            parts.append(f"**base** {_base_word(self._base)}{_because(self._base.reason)}")
        if self._lease is not None:
            parts.append(f"**operator** {self._lease.operator or 'nobody'}")
        if self._guard is not None and self._guard.reason:
            parts.append(f"**guard** {self._guard.reason}")
        if self._place:
            parts.append(f"**map** {self._place}")
        page = [drawable(part) for part in parts]
        if self._guard is not None:
            page.append("\n".join(drawable(row) for row in _table(self._guard)))
        return "\n\n".join(page)

    def _changes(self, said: dict[str, Line]) -> list[Line]:
        """Those that are new; a number that changes within a text is none."""
        new = []
        for who, (level, text) in said.items():
            gist = (level, _NUMBER.sub("", text))
            if self._told.get(who) != gist:
                self._told[who] = gist
                new.append((level, drawable(f"{who}: {text}")))
        return new


def verdicts(guard: GuardState) -> dict[str, DirectionLimit]:
    """By direction."""
    return {
        "forward": guard.forward,
        "backward": guard.backward,
        "turn left": guard.turn_left,
        "turn right": guard.turn_right,
    }


def _of_guard(guard: GuardState) -> dict[str, Line]:
    """What the guard says, without what changes with every reading."""
    said = {f"guard {way}": _of_verdict(verdict) for way, verdict in verdicts(guard).items()}
    for name, sensor in guard.sensors.items():
        said[f"sensor {name}"] = ("WARN", str(sensor.trouble)) if sensor.trouble else ("INFO", "trusted")
    return said


def _of_verdict(verdict: DirectionLimit) -> Line:
    by = f" by {verdict.sensor}" if verdict.sensor and verdict.clearance != "free" else ""
    return ("WARN" if verdict.clearance == "blocked" else "INFO"), f"{verdict.clearance}{by}"


def _of_base(base: BaseState) -> dict[str, Line]:
    return {"base": ("WARN" if base.reason else "INFO", f"{_base_word(base)}{_because(base.reason)}")}


def _of_estop(estop: EStop) -> Line:
    return ("ERROR", f"engaged by {estop.by}: {estop.reason}") if estop.engaged else ("INFO", "released")


def _base_word(base: BaseState) -> str:
    if not base.armed:
        return "not armed"
    return "driving" if base.driving else "armed, at rest"


def _because(reason: Trouble) -> str:
    return f": {reason}" if reason else ""


def _table(guard: GuardState) -> list[str]:
    rows = [
        f"| {way} | {_strong(each.clearance)} | {each.allowed:.2f} | {_cell(each.sensor)} | {_cell(str(each.reason))} |"
        for way, each in verdicts(guard).items()
    ]
    return ["| way | is | m/s, rad/s | sensor | why |", "|---|---|---|---|---|", *rows]


def _strong(clearance: Clearance) -> str:
    return clearance if clearance == "free" else f"**{clearance}**"


def _cell(text: str) -> str:
    return text.replace("|", "/") or "-"


def _of_place(pose: MapPose) -> Line:
    on = f" on {pose.map}" if pose.map else ""
    return "INFO" if pose.state == "localized" else "WARN", f"{pose.state.replace('_', ' ')}{on}{_because(pose.reason)}"
