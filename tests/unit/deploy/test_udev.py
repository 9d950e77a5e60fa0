"""deploy/udev: rules that udev takes, and the names that the robot file uses."""

import re
import tomllib

import pytest

from giraff_sim.board import ROOT
from tests.unit.deploy.udev import Device, RuleError, apply, parse, rules

TEXT = (ROOT / "deploy" / "udev" / "99-giraff.rules").read_text()
EXAMPLES = [line.removeprefix("#") for line in TEXT.splitlines() if line.startswith("#ENV")]

UNO = {"ID_VENDOR_ID": "2341", "ID_MODEL_ID": "0043"}
MEGA = {"ID_VENDOR_ID": "2341", "ID_MODEL_ID": "0042"}
CONVERTER = {"ID_VENDOR_ID": "0403", "ID_MODEL_ID": "6001", "ID_SERIAL": "FTDI_FT232R_USB_UART_A50285BI"}


def port(service: str) -> str:
    """The port's name in the robot file."""
    path: str = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())[service]["port"]
    return path.removeprefix("/dev/")


@pytest.mark.parametrize(("properties", "service"), [(UNO, "joystick"), (MEGA, "ranger")])
def test_an_arduino_has_the_name_that_the_robot_file_uses(properties: dict[str, str], service: str) -> None:
    device = apply(rules(TEXT), Device(dict(properties)))
    assert device.links == [port(service)]
    assert (device.group, device.mode) == ("dialout", "0660")
    assert device.properties["ID_MM_DEVICE_IGNORE"] == "1"


def test_any_other_port_is_left_alone() -> None:
    for properties in ({}, CONVERTER, {"ID_VENDOR_ID": "2341", "ID_MODEL_ID": "8036"}):
        device = apply(rules(TEXT), Device(dict(properties)))
        assert device == Device(dict(properties))


def test_what_is_no_port_or_goes_away_is_left_alone() -> None:
    for device in (Device(dict(UNO), subsystem="usb"), Device(dict(UNO), action="remove")):
        assert apply(rules(TEXT), device).links == []


def test_each_example_is_a_rule_that_gives_one_of_the_names() -> None:
    assert len(EXAMPLES) >= 3
    named = {term.value for line in EXAMPLES for term in parse(line) if term.key == "SYMLINK"}
    of_controller = re.search(r"--line /dev/(\S+)", (ROOT / "deploy/systemd/giraff-board@.service").read_text())
    assert of_controller is not None
    assert named == {*map(port, ("base", "joystick", "ranger", "scan")), of_controller[1]}


def test_an_example_that_is_made_a_rule_works() -> None:
    device = apply(rules(TEXT.replace(f"#{EXAMPLES[0]}", EXAMPLES[0])), Device(dict(CONVERTER)))
    assert device.links == [port("base")]
    assert device.group == "dialout"
    assert device.properties["ID_MM_DEVICE_IGNORE"] == "1"


def test_a_base_board_that_is_a_mega_and_the_rangers_are_told_apart_by_serial_number() -> None:
    any_mega = next(line for line in TEXT.splitlines() if line.startswith("ENV") and "giraff-ranger" in line)
    ours = [line for line in EXAMPLES if "ID_SERIAL_SHORT" in line]
    text = "\n".join(line.removeprefix("#") if line[1:] in ours else line for line in TEXT.splitlines())
    boards = [parse(line)[1].value for line in ours]
    for serial, service in zip(boards, ("base", "ranger"), strict=True):
        device = apply(rules(text.replace(any_mega, f"#{any_mega}")), Device({**MEGA, "ID_SERIAL_SHORT": serial}))
        assert device.links == [port(service)]


@pytest.mark.parametrize(
    "text",
    [
        'SYMLNK+="x"',
        'SYMLINK="x"',  # would take the other names away
        'ENV{A}="1" SYMLINK+="x"',
        'ENV="1"',
        'GROUP{x}="dialout"',
        'MODE=="0660"',
        'SYMLINK+="x',
        'GOTO="nowhere"',
        'LABEL="above"\nGOTO="above"',
    ],
)
def test_a_line_that_udev_would_not_take_shows(text: str) -> None:
    with pytest.raises(RuleError):
        rules(text)
