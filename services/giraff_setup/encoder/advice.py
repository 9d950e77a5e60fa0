"""Name the faults of an encoder, each with its remedy. Pure."""

from collections.abc import Iterator
from typing import Final

from giraff_schemas.trouble import Trouble
from giraff_setup.encoder.quadrature import FEWEST, Channel, Figures
from giraff_tools.terminal.text import counted

# The board counts each change of A by the level of B at that moment, so no edge of B may come near one of A. Ideally
# they are a quarter of a pair apart. With both of these limits used up, a ninth is left: 90 - 20 - 0.08 * 360 = 41 of
# 360 degrees. At 2000 edges a second of one channel that is 0.11 ms, about ten times what the board's interrupts take.
PHASE_OFF: Final = 20.0
"""Degrees of a period by which the phase may differ from 90."""
DUTY_OFF: Final = 0.08
"""Share of a period by which a channel's high part may differ from a half."""
_AT_ONCE: Final = 0.25  # of all transitions: the board calls each before which another was too short a loss
_FLICKERS: Final = 3  # in a whole drive; fewer can be chance
_FLICKERING: Final = 0.01  # of all edges


def advice(figures: Figures) -> Iterator[Trouble]:
    """Name each thing that is wrong, after its figure. Nothing: the encoder is fine."""
    if not figures.is_enough and figures.losses > _AT_ONCE * max(FEWEST, figures.transitions):
        yield Trouble(
            "A and B change at the same moment, or faster than the board can tell",
            "move sensor B by a quarter of a pair (one black and one white mark together), and check once more",
        )
    elif not figures.is_enough:
        yield Trouble(
            f"too few changes to judge: {figures.edges} at an even speed",
            "let the wheel turn freely, and raise stall_level if it turns by fits",
        )
    elif figures.silent:
        other = "B" if figures.silent == "A" else "A"
        yield Trouble(
            f"sensor {figures.silent} is silent: it did not change while sensor {other} did {figures.edges} times",
            f"check the wire, the plug and the supply of sensor {figures.silent}",
        )
    else:
        yield from _phase(figures)
        for name, channel in figures.channels:
            yield from _duty(name, channel)
            yield from _missing(name, channel)
            yield from _flickers(name, channel)


def _phase(figures: Figures) -> Iterator[Trouble]:
    if figures.phase is None:
        yield Trouble(
            "the phase between A and B changes all the time",
            "check that both sensors read the same disk, and that it is firm on its shaft",
        )
    elif abs(figures.late) > PHASE_OFF:
        way = "with" if figures.late > 0 else "against"
        yield Trouble(
            f"the phase between A and B is {figures.phase:.0f} of 360 degrees, not 90",
            f"move sensor B by {abs(figures.late) / 360:.2f} of a pair (one black and one white mark), {way} the way "
            "in which the disk turns when the wheel drives forward",
        )


def _duty(name: str, channel: Channel) -> Iterator[Trouble]:
    if channel.duty is None or abs(channel.duty - 0.5) <= DUTY_OFF:
        return
    long, short = ("high", "low") if channel.duty > 0.5 else ("low", "high")
    yield Trouble(
        f"sensor {name} is high for {channel.duty * 100:.0f} % of a pair, not 50 %: it sees its {long} mark too long "
        f"and its {short} one too short",
        f"turn its threshold, or move sensor {name} nearer to or farther from the disk",
    )


def _missing(name: str, channel: Channel) -> Iterator[Trouble]:
    if not channel.missing:
        return
    seen = f"sensor {name} passed over {counted(channel.missing, 'mark')}"
    if channel.turn is not None:
        marks, states = channel.turn.marks, channel.turn.states
        of_ring = "one mark is" if marks == 1 else f"{marks} marks are"
        yield Trouble(
            f"{seen}: of the ring of {name} {of_ring} missing or dirty, once in {states} states (a turn of "
            f"{states // 4} pairs)",
            "clean the disk, or print it anew",
        )
    elif channel.missing > 2:
        yield Trouble(
            f"{seen}, at changing places",
            f"clean the disk, and look for a loose wire of sensor {name}; it may also be too slow for this speed",
        )
    else:
        apart = "" if channel.apart is None else f", {channel.apart} states apart"
        yield Trouble(
            f"{seen}{apart}; too few to tell a bad mark of its ring from a loose wire",
            f"clean the disk, check the wire of sensor {name}, and check once more",
        )


def _flickers(name: str, channel: Channel) -> Iterator[Trouble]:
    if channel.flickers > max(_FLICKERS, _FLICKERING * channel.edges):
        yield Trouble(
            f"sensor {name} changed {channel.flickers} times to and fro where no mark begins or ends",
            f"clean the disk, move sensor {name} nearer to it, and lead its wire away from those of the motors",
        )
