"""The wires of a robot whose base board is a Mega, drawn from its pins.h: pictures of docs/build-on-two-wheels.md."""

import re
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final, NamedTuple

from tests.rules.repository import ROOT

Point = tuple[float, float]

_MARGIN, _WIDTH, _ROW, _TOP = 16, 980, 36, 112
_MEGA, _PARTS, _DRIVERS, _MOTOR = (400, 540), (96, 236), (680, 850), 920
_INK, _SIGNAL, _ENCODER, _POWER, _USB = "#333", "#1d5fa8", "#1a7a3c", "#b3261e", "#6a4a9c"
_SONARS: Final = ("front left", "front right", "rear")
"""By their numbers at the Nano."""
_NANO_PORT_B: Final = 8
"""D8 is its first pin; that of port D is D0."""


class Module(NamedTuple):
    """A motor driver."""

    title: str
    terminals: Sequence[tuple[str, str]]
    """From the top: a name of pins.h, `5 V` or `GND`, and what is printed at the terminal."""
    motors: Mapping[str, tuple[int, tuple[str, str]]]
    """By the wheel: the row of the first terminal, and both names."""
    supply: tuple[int, tuple[str, str]]


_PAIR: Final = ("M+", "M-")
_SWITCHED: Final = "12 V sw"
"""The battery behind the switch, which the motors alone have."""
MODULES: Final[Mapping[str, Sequence[Module]]] = {
    "mega_l298n": (
        Module(
            "L298N or TB6612FNG",
            (
                ("MOTOR_0_PWM", "ENA, PWMA"),
                ("MOTOR_0_IN1", "IN1, AIN1"),
                ("MOTOR_0_IN2", "IN2, AIN2"),
                ("MOTOR_1_IN1", "IN3, BIN1"),
                ("MOTOR_1_IN2", "IN4, BIN2"),
                ("MOTOR_1_PWM", "ENB, PWMB"),
                ("ENABLE", "STBY of a TB"),
                ("5 V", "5V, VCC"),
                ("GND", "GND"),
            ),
            {"left": (0, ("OUT1, AO1", "OUT2, AO2")), "right": (3, ("OUT3, BO1", "OUT4, BO2"))},
            (5, ("12V, VM", "GND")),
        ),
    ),
    "mega_bts7960": (
        Module(
            "left BTS7960",
            (
                ("5 V", "VCC"),
                ("GND", "GND"),
                ("MOTOR_0_RPWM", "RPWM"),
                ("MOTOR_0_LPWM", "LPWM"),
                ("MOTOR_0_ENABLE", "R_EN and L_EN"),
            ),
            {"left": (0, _PAIR)},
            (3, ("B+", "B-")),
        ),
        Module(
            "right BTS7960",
            (
                ("MOTOR_1_ENABLE", "R_EN and L_EN"),
                ("MOTOR_1_RPWM", "RPWM"),
                ("MOTOR_1_LPWM", "LPWM"),
                ("5 V", "VCC"),
                ("GND", "GND"),
            ),
            {"right": (0, _PAIR)},
            (3, ("B+", "B-")),
        ),
    ),
}
_NOTES: Final[Mapping[str, Sequence[str]]] = {
    "mega_l298n": (
        "L298N: take off the jumpers of ENA, of ENB and of its",
        "5 V regulator. ENA and ENB are the pins in the row of",
        "IN1 to IN4. Only a TB6612FNG (TB) has STBY.",
    ),
    "mega_bts7960": (
        "R_EN and L_EN of a module are one wire. R_IS and",
        "L_IS stay free.",
    ),
}
_LEGEND: Final = (
    "Wires with one label, or with the sign of ground,",
    "are joined. 5 V is that of the Mega, 12 V sw is",
    "behind the switch.",
    "10k: a pull-down of 10 kΩ, at the driver's end.",
)


def pins(board: str) -> dict[str, int]:
    """Return the numbers of a board's pins.h, by their names."""
    source = (ROOT / "firmware" / "boards" / board / "pins.h").read_text(encoding="utf-8")
    return {name: int(number) for name, number in re.findall(r"^#define (\w+) (\d+)\b", source, re.MULTILINE)}


def outputs(board: str) -> list[str]:
    """Return the names of the pins that go to a motor driver, each once, from the top of the picture."""
    named = dict.fromkeys(name for module in MODULES[board] for name, _ in module.terminals)
    return [name for name in named if name.isidentifier() and name != "GND"]


def picture(board: str) -> Path:
    """Return the path of the picture."""
    return ROOT / "docs" / "pictures" / f"wires-{board}.svg"


class _Canvas:
    """Lines of SVG."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def text(self, at: Point, said: str, anchor: str = "start", *, color: str = _INK, bold: bool = False) -> None:
        weight = ' font-weight="bold"' if bold else ""
        self.lines.append(
            f'<text x="{at[0]:g}" y="{at[1] + 4:g}" text-anchor="{anchor}" fill="{color}"{weight}>{escape(said)}</text>'
        )

    def wire(self, color: str, *points: Point) -> None:
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self.lines.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="2"/>')

    def box(self, left: float, top: float, right: float, bottom: float, title: str, *more: str) -> None:
        self.lines.append(
            f'<rect x="{left:g}" y="{top:g}" width="{right - left:g}" height="{bottom - top:g}" rx="6"'
            f' fill="#f4f1e8" stroke="#a98" stroke-width="1.5"/>'
        )
        for number, line in enumerate((title, *more)):
            self.text(((left + right) / 2, top + 16 + 16 * number), line, "middle", bold=not number)

    def joint(self, at: Point, color: str) -> None:
        self.lines.append(f'<circle cx="{at[0]:g}" cy="{at[1]:g}" r="3.5" fill="{color}"/>')

    def motor(self, at: Point, wheel: str) -> None:
        x, y = at
        self.lines.append(f'<circle cx="{x:g}" cy="{y:g}" r="28" fill="#f4f1e8" stroke="#a98" stroke-width="1.5"/>')
        self.text((x, y - 8), wheel, "middle", bold=True)
        self.text((x, y + 8), "motor", "middle")

    def resistor(self, left: float, top: float, width: float, height: float) -> None:
        self.lines.append(
            f'<rect x="{left:g}" y="{top:g}" width="{width:g}" height="{height:g}" fill="#fff" stroke="{_INK}"'
            ' stroke-width="1.5"/>'
        )

    def ground(self, at: Point) -> None:
        """The sign below a point."""
        x, y = at
        self.wire(_INK, at, (x, y + 5))
        for number, half in enumerate((8, 5, 2)):
            self.wire(_INK, (x - half, y + 5 + 3 * number), (x + half, y + 5 + 3 * number))

    def pull_down(self, at: Point, said: str) -> None:
        """A resistor from a wire to ground."""
        x, y = at
        self.joint(at, _INK)
        self.wire(_INK, at, (x, y + 5))
        self.resistor(x - 4, y + 5, 8, 13)
        self.text((x + 9, y + 12), said)
        self.ground((x, y + 18))

    def label(self, end: Point, said: str, *, towards: int) -> None:
        """The end of a wire that has `said` for its name; `towards`: -1 to the left of the point, 1 to the right."""
        (x, y), width = end, 16 + 7 * len(said)
        middle = x + towards * width / 2
        self.lines.append(
            f'<rect x="{middle - width / 2:g}" y="{y - 9:g}" width="{width}" height="18" rx="4" fill="{_POWER}"/>'
        )
        self.text((middle, y), said, "middle", color="#fff", bold=True)

    def supply(self, edge: Point, said: str, *, towards: int) -> None:
        """A wire from a part's edge to ground or to a label."""
        x, y = edge
        if said == "GND":
            self.wire(_INK, edge, (x + towards * 24, y))
            self.ground((x + towards * 24, y))
        else:
            self.wire(_POWER, edge, (x + towards * 16, y))
            self.label((x + towards * 16, y), said, towards=towards)


def _y(row: float) -> float:
    return _TOP + _ROW * row


def _draw_encoders(canvas: _Canvas, numbers: Mapping[str, int]) -> None:
    for index, side in enumerate(("left", "right")):
        first = 2 * index
        canvas.box(_PARTS[0], _y(first) - 16, _PARTS[1], _y(first + 1) + 16, "encoder", f"{side} motor")
        for row, channel in ((first, "A"), (first + 1, "B")):
            canvas.text((_PARTS[1] - 6, _y(row)), channel, "end")
            canvas.wire(_ENCODER, (_PARTS[1], _y(row)), (_MEGA[0], _y(row)))
            canvas.text((_MEGA[0] + 8, _y(row)), f"D{numbers[f'ENCODER_{index}_{channel}']}")
        canvas.supply((_PARTS[0], _y(first)), "5 V", towards=-1)
        canvas.supply((_PARTS[0], _y(first + 1)), "GND", towards=-1)


def _draw_divider(canvas: _Canvas, numbers: Mapping[str, int]) -> None:
    y, joint = _y(5), 320
    canvas.wire(_POWER, (_PARTS[0], y), (_MEGA[0], y))
    canvas.label((_PARTS[0], y), "12 V", towards=-1)
    canvas.resistor(190, y - 5, 26, 10)
    canvas.text((203, y - 14), "10k", "middle")
    canvas.text((180, y + 22), "measures the battery", "middle")
    canvas.pull_down((joint, y), "4.7k")
    canvas.text((_MEGA[0] + 8, y), f"A{numbers['BATTERY_CHANNEL']}")
    for row, said in ((7, "5 V"), (8, "GND")):
        canvas.text((_MEGA[0] + 8, _y(row)), said)
        canvas.supply((_MEGA[0], _y(row)), said, towards=-1)


def _draw_modules(canvas: _Canvas, modules: Sequence[Module], numbers: Mapping[str, int]) -> None:
    left, right = _DRIVERS
    row = 0
    for module in modules:
        top, last = row, row + len(module.terminals) - 1
        canvas.box(left, _y(top) - 42, right, _y(last) + 16, module.title)
        for name, printed in module.terminals:
            y = _y(row)
            canvas.text((left + 6, y), printed)
            if name not in numbers:
                canvas.supply((left, y), name, towards=-1)
            else:
                canvas.wire(_SIGNAL, (_MEGA[1], y), (left, y))
                canvas.text((_MEGA[1] - 8, y), f"D{numbers[name]}", "end")
                canvas.pull_down((_MEGA[1] + 56, y), "10k")
            row += 1
        for wheel, (first, terminals) in module.motors.items():
            middle = (_y(top + first) + _y(top + first + 1)) / 2
            for offset, printed in enumerate(terminals):
                y = _y(top + first + offset)
                canvas.text((right - 6, y), printed, "end")
                canvas.wire(_POWER, (right, y), (_MOTOR, y), (_MOTOR, middle))
            canvas.motor((_MOTOR, middle), wheel)
        first, terminals = module.supply
        for offset, (printed, said) in enumerate(zip(terminals, (_SWITCHED, "GND"), strict=True)):
            canvas.text((right - 6, _y(top + first + offset)), printed, "end")
            canvas.supply((right, _y(top + first + offset)), said, towards=1)
        row += 1  # the title of the next one


def _draw_power(canvas: _Canvas, top: float, mega_bottom: float) -> None:
    y, pi = top + 34, (410, 530)
    canvas.wire(_POWER, (100, y), (pi[0], y))
    below = y + 58
    canvas.wire(_POWER, (216, y), (216, below), (228, below), (250, below - 12))
    canvas.wire(_POWER, (254, below), (262, below))
    canvas.label((262, below), _SWITCHED, towards=1)
    canvas.text((240, below + 14), "switch", "middle")
    for x in (180, 216):
        canvas.joint((x, y), _POWER)
    canvas.box(_MARGIN, top, 100, top + 68, "battery", "12 V")
    canvas.ground((58, top + 68))
    canvas.resistor(120, y - 6, 34, 12)
    canvas.text((137, y - 16), "fuse", "middle")
    canvas.wire(_POWER, (180, y), (180, y - 30))
    canvas.label((160, y - 38), "12 V", towards=1)
    canvas.box(276, top, 376, top + 68, "converter", "to 5 V")
    canvas.ground((360, top + 68))
    canvas.box(pi[0], top, pi[1], top + 68, "Raspberry Pi")
    canvas.wire(_USB, (470, top), (470, mega_bottom))
    canvas.text((478, (top + mega_bottom) / 2), "USB", color=_USB)
    canvas.wire(_USB, (pi[1], y), (630, y))
    canvas.text((580, y - 10), "USB", "middle", color=_USB)


def _draw_ranger(canvas: _Canvas, top: float) -> float:
    """Draw the Nano with its sensors, and return where they end."""
    numbers = pins("nano_ranger")
    pitch, (left, right), sensor = 28, (630, 745), (800, 956)
    bottom = top + 26 + pitch * 6
    canvas.box(left, top, right, bottom, "Arduino Nano")
    for index, name in enumerate(_SONARS):
        trigger, echo = _NANO_PORT_B + numbers["TRIGGER_0"] + index, numbers["ECHO_0"] + index
        first = top + 40 + pitch * 2 * index
        canvas.box(sensor[0], first - 14, sensor[1], first + pitch + 12, "")
        canvas.text((sensor[1] - 8, first), "HC-SR04", "end", bold=True)
        canvas.text((sensor[1] - 8, first + 18), name, "end")
        for y, number, printed in ((first, trigger, "Trig"), (first + pitch, echo, "Echo")):
            canvas.text((right - 8, y), f"D{number}", "end")
            canvas.wire(_SIGNAL, (right, y), (sensor[0], y))
            canvas.text((sensor[0] + 8, y), printed)
    canvas.text((sensor[1], bottom + 14), "VCC and GND of all three: 5 V and GND of the Nano", "end")
    return bottom + 24


def draw(board: str) -> str:
    """Return the picture of this board, as SVG."""
    numbers, canvas = pins(board), _Canvas()
    rows = sum(len(module.terminals) + 1 for module in MODULES[board]) - 1
    mega_bottom = _y(rows - 1) + 20
    canvas.text((_MARGIN, 26), f"The wires of board {board}", bold=True)
    canvas.box(_MEGA[0], _TOP - 48, _MEGA[1], mega_bottom, "Arduino Mega")
    _draw_encoders(canvas, numbers)
    _draw_divider(canvas, numbers)
    _draw_modules(canvas, MODULES[board], numbers)
    top = mega_bottom + 46
    _draw_power(canvas, top, mega_bottom)
    notes = (*_LEGEND, *_NOTES[board])
    height = max(_draw_ranger(canvas, top), top + 130 + 18 * len(notes))
    for number, line in enumerate(notes):
        canvas.text((_MARGIN, top + 130 + 18 * number), line)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:g}" width="{_WIDTH}"'
        ' font-family="sans-serif" font-size="13">\n'
        f'<rect width="{_WIDTH}" height="{height:g}" fill="#fff"/>'
    )
    return "\n".join([head, *canvas.lines, "</svg>", ""])
