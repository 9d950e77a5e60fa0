#!/usr/bin/env python3
"""Write schemas/giraff_schemas/wire.py, the Python side of the wire, from common/protocol.h.

The header is the only declaration of the wire, but for the headers of EXTENSIONS, which have a codec each. A board
whose whole wire stands in such a header has a protocol hash of its own, which covers both headers. This reads
the part of C they are written in and refuses the rest: `enum name { NAME = number, ... };`, such enums without a name
for constants, and `struct PACKED name { integer fields };`, whose last field may be an array.

Usage: generate_codec.py           write the codecs
       generate_codec.py --check   fail when a codec is not what its header gives
       generate_codec.py --hash [balancer/balancer_protocol.h]
                                   print the protocol hash of a board, for -DPROTOCOL_HASH=
"""

import argparse
import hashlib
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

FIRMWARE = Path(__file__).resolve().parent
HEADER = FIRMWARE / "common" / "protocol.h"
SCHEMAS = FIRMWARE.parent / "schemas" / "giraff_schemas"
WIRE = SCHEMAS / "wire.py"
EXTENSIONS = {
    FIRMWARE / "common" / "boards.h": SCHEMAS / "wires" / "boards.py",
    FIRMWARE / "base" / "transitions_protocol.h": SCHEMAS / "wires" / "transitions.py",
    FIRMWARE / "ranger" / "bumper_protocol.h": SCHEMAS / "wires" / "bumper.py",
    FIRMWARE / "balancer" / "balancer_protocol.h": SCHEMAS / "wires" / "balancer.py",
}
WHOLE_WIRES = {FIRMWARE / "balancer" / "balancer_protocol.h"}

STRUCT_CODES = {
    "uint8_t": "B",
    "int8_t": "b",
    "uint16_t": "H",
    "int16_t": "h",
    "uint32_t": "I",
    "int32_t": "i",
    "uint64_t": "Q",
    "int64_t": "q",
}


class HeaderError(Exception):
    """The header holds something this generator does not understand."""


@dataclass
class Enum:
    name: str
    members: dict[str, int] = field(default_factory=dict)


@dataclass
class Record:
    name: str
    fields: dict[str, str] = field(default_factory=dict)  # field name: C type
    length: int = 0  # of the last field, which is an array; 0: no field is


@dataclass
class Protocol:
    enums: list[Enum]
    constants: dict[str, int]
    records: list[Record]
    hash: int
    source: str

    @property
    def types(self) -> Enum:
        """The enum of its frame types."""
        return next((e for e in self.enums if e.name.endswith("frame_type")), Enum("frame_type"))


def without_comments(source: str) -> str:
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", source, flags=re.DOTALL)


def tokens(source: str) -> list[str]:
    return re.findall(r"\w+|[^\w\s]", source)


def protocol_hash(source: str) -> int:
    """The first 32 bits of the SHA-256 of the header's tokens: comments and white space do not count."""
    text = " ".join(tokens(without_comments(source)))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


class Parser:
    """A reader of tokens that knows where it wants which."""

    def __init__(self, words: list[str]) -> None:
        self._words = words
        self._at = 0

    def more(self) -> bool:
        return self._at < len(self._words)

    def peek(self) -> str:
        return self._words[self._at] if self.more() else "the end"

    def take(self, pattern: str) -> str:
        word = self.peek()
        if not re.fullmatch(pattern, word):
            before = " ".join(self._words[max(0, self._at - 5) : self._at])
            raise HeaderError(f"after '{before}': '{word}' is not {pattern}")
        self._at += 1
        return word

    def number(self) -> int:
        return int(self.take(r"0[xX][0-9a-fA-F]+|\d+"), 0)


def parse(source: str, extended: Protocol | None = None) -> Protocol:
    """`extended`: what the header adds its frames to."""
    lines = without_comments(source).splitlines()
    parser = Parser(tokens("\n".join(line for line in lines if not line.lstrip().startswith("#"))))
    protocol = Protocol(
        [], {}, [], protocol_hash(source if extended is None else f"{extended.source}\n{source}"), source
    )
    while parser.more():
        if parser.take("enum|struct") == "enum":
            enum = parse_enum(parser)
            if enum.name:
                protocol.enums.append(enum)
            else:
                protocol.constants.update(enum.members)
        else:
            protocol.records.append(parse_struct(parser, protocol.constants))
    check(protocol)
    numbers = {*protocol.types.members.values()}
    if extended and numbers & {*extended.types.members.values()}:
        raise HeaderError("a frame type has a number of protocol.h")
    return protocol


def parse_enum(parser: Parser) -> Enum:
    enum = Enum("" if parser.peek() == "{" else parser.take(r"[a-z]\w*"))
    parser.take(r"\{")
    while parser.peek() != "}":
        name = parser.take(r"[A-Z]\w*")
        parser.take("=")
        enum.members[name] = parser.number()
        if parser.peek() != "}":
            parser.take(",")
    parser.take(r"\}")
    parser.take(";")
    return enum


def parse_struct(parser: Parser, constants: dict[str, int]) -> Record:
    parser.take("PACKED")
    record = Record(parser.take(r"[a-z]\w*"))
    parser.take(r"\{")
    while parser.peek() != "}" and not record.length:
        kind = parser.take("|".join(STRUCT_CODES))
        record.fields[parser.take(r"[a-z]\w*")] = kind
        if parser.peek() == "[":
            parser.take(r"\[")
            record.length = constants[parser.take("|".join(constants) or "a constant above")]
            parser.take(r"\]")
        parser.take(";")
    parser.take(r"\}")
    parser.take(";")
    return record


def check(protocol: Protocol) -> None:
    """Each frame type has its struct and each struct its type, and all begin alike."""
    types = protocol.types.members
    wanted = {"FRAME_" + r.name.upper() for r in protocol.records}
    if wanted != set(types):
        raise HeaderError(f"frame type without struct, or struct without type: {sorted(wanted ^ set(types))}")
    if len(set(types.values())) != len(types):
        raise HeaderError("two frame types have one number")
    for record in protocol.records:
        if list(record.fields.items())[:2] != [("type", "uint8_t"), ("seq", "uint16_t")]:
            raise HeaderError(f"struct {record.name} does not begin with 'uint8_t type; uint16_t seq;'")


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def common_prefix(names: list[str]) -> str:
    """What the members' names share, up to an underscore: all of C's enums share one name space."""
    first, last = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), len(first))
    return first[: first.rfind("_", 0, same) + 1]


def enum_lines(enum: Enum) -> list[str]:
    single_bits = all(value and not value & (value - 1) for value in enum.members.values())
    base = "IntFlag" if single_bits else "IntEnum"
    prefix = common_prefix(list(enum.members))
    lines = [f"class {camel(enum.name)}({base}):", f'    """enum {enum.name}"""', ""]
    return [*lines, *(f"    {name.removeprefix(prefix)} = {value}" for name, value in enum.members.items())]


def record_lines(record: Record, types: str) -> list[str]:
    codes = [STRUCT_CODES[kind] for kind in record.fields.values()]
    codes[-1] = f"{record.length or ''}{codes[-1]}"
    layout = "<" + "".join(codes)
    own = dict.fromkeys((name for name in record.fields if name not in ("type", "seq")), "int")
    if record.length:
        own[list(own)[-1]] = "tuple[int, ...]"
    return [
        f"class {camel(record.name)}Frame(Frame, frozen=True):",
        f'    """struct {record.name}"""',
        "",
        f"    type: ClassVar[int] = {types}.{record.name.upper()}",
        f'    layout: ClassVar[struct.Struct] = struct.Struct("{layout}")',
        *([""] if own else []),
        *(f"    {name}: {type_}" for name, type_ in own.items()),
        *(array_lines(record) if record.length else []),
    ]


def array_lines(record: Record) -> list[str]:
    """How a frame whose last field is an array becomes a body, and comes from it."""
    *single, array = (name for name in record.fields if name != "type")
    return [
        "",
        "    def pack(self) -> bytes:",
        f'        """The frame\'s body; struct.error unless `{array}` are {record.length}, and each value fits."""',
        f"        single = ({', '.join(f'self.{name}' for name in single)})",
        f"        return self.layout.pack(self.type, *single, *self.{array})",
        "",
        "    @classmethod",
        "    def unpack(cls, body: bytes) -> Self:",
        '        """The frame of a body of this type; struct.error when its length is another\'s."""',
        f"        _, {', '.join(single)}, *{array} = cls.layout.unpack(body)",
        f"        return cls({', '.join(single)}, tuple({array}))",
    ]


PREAMBLE = '''"""The wire between a host and the boards. Generated by firmware/generate_codec.py from
firmware/common/protocol.h, which says what each field means: change that, not this.
"""

import struct
from enum import IntEnum, IntFlag
from typing import ClassVar, Final, Self

import msgspec
'''

EXTENSION_PREAMBLE = '''"""Frames beside `wire`. Generated by firmware/generate_codec.py from
firmware/{header}, which says what each field means: change that, not this.
"""

import struct
from enum import {enums}
from typing import {typing}

from giraff_schemas.wire import Frame
'''

CONSTANTS_PREAMBLE = '''"""Numbers beside `wire`. Generated by firmware/generate_codec.py from
firmware/{header}, which says what each means: change that, not this.
"""

from typing import Final
'''

BASE_CLASS = '''class Frame(msgspec.Struct, frozen=True):
    """What every frame has: its type, its sender's sequence number, and a packed little-endian layout."""

    type: ClassVar[int]
    layout: ClassVar[struct.Struct]

    seq: int

    def pack(self) -> bytes:
        """The frame's body; struct.error when a value does not fit its field."""
        return self.layout.pack(self.type, *msgspec.structs.astuple(self))

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        """The frame of a body of this type; struct.error when its length is another's."""
        return cls(*cls.layout.unpack(body)[1:])'''


def generate(protocol: Protocol, extension: str = "", *, is_whole: bool = True) -> str:
    """`extension`: the header of frames beside protocol.h; empty: it is protocol.h. `is_whole`: with a hash."""
    types = camel(protocol.types.name)
    constants = [f"{name}: Final = {value}" for name, value in protocol.constants.items()]
    if not protocol.records:
        return "\n".join([CONSTANTS_PREAMBLE.format(header=extension), *constants, ""])
    table = [
        "FRAME_CLASSES: Final[dict[int, type[Frame]]] = {",
        *(f"    {types}.{r.name.upper()}: {camel(r.name)}Frame," for r in protocol.records),
        "}",
    ]
    proof = f"PROTOCOL_HASH: Final = 0x{protocol.hash:08X}\n\n" if is_whole else ""
    blocks = [
        proof + "\n".join(constants),
        *("\n".join(enum_lines(enum)) for enum in protocol.enums),
        *([] if extension else [BASE_CLASS]),
        *("\n".join(record_lines(record, types)) for record in protocol.records),
        "\n".join(table),
    ]
    body = "\n\n\n".join(blocks) + "\n"
    enums = "IntEnum, IntFlag" if "(IntFlag)" in body else "IntEnum"
    typing = "ClassVar, Final, Self" if "Self:" in body else "ClassVar, Final"
    preamble = EXTENSION_PREAMBLE.format(header=extension, enums=enums, typing=typing) if extension else PREAMBLE
    return f"{preamble}\n{body}"


def main() -> int:
    arguments = argparse.ArgumentParser(description="Write the Python codec of the boards' wire.")
    mode = arguments.add_mutually_exclusive_group()
    mode.add_argument("--check", action="store_true", help="fail when the codec is not what the header gives")
    mode.add_argument("--hash", nargs="?", const=HEADER, type=Path, metavar="HEADER", help="print a protocol hash")
    asked = arguments.parse_args()
    header = HEADER
    try:
        protocol = parse(HEADER.read_text(encoding="utf-8"))
        texts, hashes = {(HEADER, WIRE): generate(protocol)}, {HEADER: protocol.hash}
        for header, codec in EXTENSIONS.items():
            extension = parse(header.read_text(encoding="utf-8"), protocol)
            is_whole = header in WHOLE_WIRES
            texts[header, codec] = generate(extension, header.relative_to(FIRMWARE).as_posix(), is_whole=is_whole)
            if is_whole:
                hashes[header] = extension.hash
    except HeaderError as error:
        print(f"{header}: {error}", file=sys.stderr)
        return 1
    if asked.hash:
        if (wanted := (FIRMWARE / asked.hash).resolve()) not in hashes:
            print(f"{wanted} declares no whole wire", file=sys.stderr)
            return 1
        print(f"0x{hashes[wanted]:08X}")
        return 0
    code = 0
    for (header, codec), text in texts.items():
        if not asked.check:
            codec.write_text(text, encoding="utf-8")
        elif not codec.exists() or codec.read_text(encoding="utf-8") != text:
            print(f"{codec} is not what {header} gives: run {Path(__file__).resolve()}", file=sys.stderr)
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main())
