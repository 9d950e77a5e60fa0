"""Each command that reads a recording reads what is sound of a bad one, and its exit code tells that it was not all."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import pytest
from mcap.writer import Writer

import giraff_cli.play.reader as reading
from giraff_mcap.layout import look_through
from giraff_mcap.reading import Recorded, Recording, RecordingError
from giraff_mcap.unread import Unread
from giraff_mcap.writing import ABOUT, RAW
from giraff_schemas.format import FORMAT
from giraff_schemas.params import ParamAnswer
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff
from tests.unit.replay.drive import begin_of_the_drive

ROOM: Final = """
name = "room"
start = { x = 1.0, y = 1.0, yaw_deg = 0.0 }
[[walls]]
name = "room"
points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
closed = true
"""
TOPIC: Final = "giraff/sim-test/odom"
NO_JSON: Final = {
    "not a number": b'{"x": NaN}',
    "infinity": b'{"x": -Infinity}',
    "a large integer": b'{"x": 123456789012345678901234567890}',
    "no JSON": b"hello",
    "no text": b'{"x": "\xff"}',
}
ANSWER: Final = ParamAnswer(service="base", instance="i-1", host="", done=True, params=())
NO_KEYS: Final = ("giraff/sim-test//camera", "/camera/image", "giraff/sim-test/**")


class Bad(NamedTuple):
    """A file, and what every command says of it."""

    path: Path
    samples: int
    """Number of samples that can be read."""
    told: tuple[str, ...]


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Recorded]]:
    """The first two seconds of the drive, as foreign tools write them: JSON, in small chunks."""
    path = tmp_path_factory.mktemp("drive") / "own.mcap"
    return path, begin_of_the_drive(path, 2_000_000_000)


def foreign(
    path: Path, recorded: list[Recorded], *, strange: bool = False, torn: bytes = b"", number: str = str(FORMAT)
) -> Path:
    """Write these as another tool does. `strange`: with messages that are no samples in between.

    `torn`: with this payload of odometry as well, as it was on the network. `number`: of the format; empty: none.
    """
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=10_000)
        writer.start()
        if number:
            writer.add_metadata(ABOUT, {"format": number})
        channels: dict[tuple[str, str], int] = {}

        def say(topic: str, data: bytes, at_ns: int, encoding: str = "json") -> None:
            if (topic, encoding) not in channels:
                channels[topic, encoding] = writer.register_channel(topic, encoding, 0)
            writer.add_message(channels[topic, encoding], at_ns, data, at_ns)

        for index, sample in enumerate(recorded):
            say(sample.topic, json.dumps(sample.content(), default=str).encode(), sample.heard_ns)
            if strange and index == 20:
                for data in NO_JSON.values():
                    say(TOPIC, data, sample.heard_ns)
                for topic in NO_KEYS:
                    say(topic, b"{}", sample.heard_ns)
                say("giraff/sim-test/image", b"\x08\x01", sample.heard_ns, "protobuf")
        if torn:
            say(TOPIC, torn, recorded[-1].heard_ns, RAW)
        writer.finish()
    return path


@pytest.fixture(params=["damaged", "strange"])
def bad(request: pytest.FixtureRequest, tmp_path: Path, drive: tuple[Path, list[Recorded]]) -> Bad:
    _, recorded = drive
    path = foreign(tmp_path / "bad.mcap", recorded, strange=request.param == "strange")
    if request.param == "strange":
        lines = [f"5 samples of {TOPIC} left out: no JSON", "giraff/sim-test/image left out: its messages are protobuf"]
        lines += [f"1 sample of {topic} left out: its topic is " for topic in NO_KEYS]
        return Bad(path, len(recorded), tuple(lines))
    with path.open("rb") as file:
        part = look_through(file).parts[4]
    data = bytearray(path.read_bytes())
    data[part.offset + part.size // 2] ^= 0x10
    path.write_bytes(data)
    assert part.messages
    return Bad(path, len(recorded) - part.messages, (f"damaged: {part.messages} samples after ",))


COMMANDS: Final = {
    "repair": ("record", "--repair", "{}", "-o", "{}.repaired", "--json"),
    "play": ("play", "{}", "--rate", "100", "--json"),
    "replay": ("replay", "{}", "--json"),
    "view": ("view", "{}", "--save", "{}.rrd"),
    "localize": ("localize", "--from", "{}", "--map", "room.toml", "--json"),
    "vision": ("vision", "--from", "{}", "--json"),
}


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """The keys that are published, on a network where nobody is. The robot file at hand is the example."""
    network, keys = meet(monkeypatch), list[str]()
    session = network.open(None)
    session.declare_publisher.side_effect = lambda key, **_: type("", (), {"put": lambda _, __: keys.append(key)})()
    monkeypatch.setattr("zenoh.open", lambda _: session)
    monkeypatch.setenv("GIRAFF_CONFIG", str(ROOT / "deploy" / "robot.toml"))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.toml").write_text(ROOM, encoding="utf-8")
    return keys


@pytest.fixture
def giraff(giraff: Giraff, said: list[str]) -> Giraff:
    """A command, typed where `said` is."""
    assert not said
    return giraff


@pytest.mark.parametrize("command", [command for command in COMMANDS if command != "vision"])
def test_what_is_sound_is_read_and_the_rest_is_named_and_counted(
    bad: Bad, giraff: Giraff, said: list[str], command: str
) -> None:
    code, out, complaint = giraff(*(word.format(bad.path) for word in COMMANDS[command]))
    assert code == 1, (out, complaint)
    assert "Traceback" not in complaint
    if command == "localize":  # reads three keys alone
        assert "left out" in complaint or "damaged: " in complaint
        return
    for line in bad.told:
        assert line in (complaint if command != "repair" else json_texts(out)), complaint
    if command == "repair":
        assert json.loads(out)["samples"] == bad.samples
        assert len(list(Recording(Path(f"{bad.path}.repaired")).samples())) == bad.samples
    if command == "play":
        assert json.loads(out)["samples"] == bad.samples == len(said)
        assert not [key for key in said if "*" in key or "//" in key]


@pytest.mark.parametrize("command", ["repair", "replay", "view", "localize"])
def test_a_sample_that_cannot_be_decoded_is_told(
    tmp_path: Path, giraff: Giraff, drive: tuple[Path, list[Recorded]], command: str
) -> None:
    path = foreign(tmp_path / "torn.mcap", drive[1], torn=b"\xc1")
    code, out, complaint = giraff(*(word.format(path) for word in COMMANDS[command]))
    assert code == 1, (out, complaint)
    if command == "repair":
        assert json.loads(out)["unread"]["left_out"][TOPIC]["samples"] == 1
    else:
        assert "samples could not be read" in complaint or "left out: " in complaint


def json_texts(out: str) -> str:
    """What a repair's JSON says is missing, as text."""
    return "\n".join(msgspec.json.decode(msgspec.json.encode(json.loads(out)["unread"]), type=Unread).texts())


OTHER_FORMATS: Final = {
    str(FORMAT + 1): f"was recorded by a Giraff of format {FORMAT + 1}, and this one reads {FORMAT}",
    "": f"has no format number, and this Giraff reads {FORMAT}",
}


@pytest.mark.parametrize("number", OTHER_FORMATS)
def test_a_recording_of_another_format_is_passed_on_and_never_decoded(
    tmp_path: Path, giraff: Giraff, said: list[str], drive: tuple[Path, list[Recorded]], number: str
) -> None:
    path = foreign(tmp_path / "other.mcap", drive[1], number=number)
    for command in ("replay", "view", "localize", "vision"):
        told = f"giraff: {path} {OTHER_FORMATS[number]}; use the Giraff that recorded it, or record again\n"
        assert giraff(*(word.format(path) for word in COMMANDS[command])) == (2, "", told)
    for command in ("repair", "play"):
        assert giraff(*(word.format(path) for word in COMMANDS[command]))[::2] == (0, "")
    assert len(said) == len(drive[1])
    repaired = Recording(Path(f"{path}.repaired"), any_format=True)
    assert repaired.about.get("format", "") == number
    assert sum(count.samples for count in repaired.counts.values()) == len(drive[1])


def test_what_is_whole_ends_with_zero(
    tmp_path: Path, giraff: Giraff, said: list[str], drive: tuple[Path, list[Recorded]]
) -> None:
    path = foreign(tmp_path / "whole.mcap", drive[1])
    for command in ("repair", "play", "view"):
        code, out, complaint = giraff(*(word.format(path) for word in COMMANDS[command]))
        assert (code, complaint) == (0, ""), out
    assert len(said) == len(drive[1])


def test_a_long_gap_is_told_or_left_out(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, giraff: Giraff, drive: tuple[Path, list[Recorded]]
) -> None:
    # Otherwise the waiting for the reader's thread takes some of this clock's time.
    monkeypatch.setattr(reading.Reader, "start", reading.Reader._run)
    hour = 3_600_000_000_000
    late = [*drive[1][:10], *(replace(each, heard_ns=each.heard_ns + hour) for each in drive[1][10:20])]
    path = foreign(tmp_path / "late.mcap", late)
    code, out, complaint = giraff("play", str(path), "--json")
    assert (code, json.loads(out)["samples"]) == (0, 20)
    assert "the next sample comes in 3600 s (--skip-gaps leaves that out)" in complaint
    code, out, complaint = giraff("play", str(path), "--json", "--skip-gaps")
    assert (code, complaint) == (0, "")
    assert json.loads(out)["seconds"] < 3.0


@pytest.mark.parametrize(
    ("key", "content", "maker"),
    [
        ("odom", {"seq": 1, "instance": "i-1"}, "i-1-2"),
        ("param/base", msgspec.to_builtins(ANSWER), "i-1-2"),
        ("mine", {"instance": "i-1", 1: 2}, "i-1"),
    ],
)
def test_a_second_round_has_makers_of_its_own_and_leaves_foreign_payloads(
    key: str, content: dict[Any, Any], maker: str
) -> None:
    sample = Recorded("", key, 0, 0, 0, msgspec.msgpack.encode(content), "")
    assert reading._payload(sample, 2) == msgspec.msgpack.encode(content | {"instance": maker})


def test_what_ends_the_reading_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, giraff: Giraff, drive: tuple[Path, list[Recorded]]
) -> None:
    """It is a fault of this program then, and told as one."""

    def fail(*_: Any) -> bytes:
        raise RuntimeError("out of order")

    monkeypatch.setattr(reading, "_payload", fail)
    with pytest.raises(RuntimeError, match="out of order"):
        giraff("play", str(drive[0]))


def test_a_file_that_is_gone_meanwhile_is_told(
    monkeypatch: pytest.MonkeyPatch, giraff: Giraff, drive: tuple[Path, list[Recorded]]
) -> None:
    def gone(*_: Any) -> bytes:
        raise RecordingError("it is gone")

    monkeypatch.setattr(reading, "_payload", gone)
    code, _, complaint = giraff("play", str(drive[0]))
    assert (code, complaint) == (1, "giraff: it is gone\n")
