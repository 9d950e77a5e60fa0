"""The truth about what passes through the processes: when it was measured, by whom, and what it stands on.

Kept beside the samples, by maker and number: no policy sees any of it. All times are simulated us.
"""

from collections import defaultdict, deque
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from giraff_schemas.messages import BaseState, DriveCommand, GuardedCommand, Lease, Range
from giraff_schemas.requests import EStopEngage, EStopReset
from giraff_schemas.wire import BoardKind, Frame, RangeFrame, TiltFrame
from giraff_sim.dst.judging.true_input import TrueInput
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.body import BoardReport

_HEARD_US: Final = 1_000_000  # for so long what base was handed explains what it does, or shows what is wrong with it
_STEADY_US: Final = 100_000  # between two reports of the base board, which come every 10 ms
_LONGEST_GAP_US: Final = 150_000  # between two neutral commands of one held neutral

BASE: Final = "base"
"""Name of the base process that has the board; another one is a fault."""

Made = tuple[str, int]
"""Maker's instance and the sample's number."""


class Given(NamedTuple):
    """An operator's command."""

    command: DriveCommand
    born_us: int
    """Of the measurement, or of the key press."""


class Passed(NamedTuple):
    """A guard's command, and what the guard had heard when it made it."""

    command: GuardedCommand
    at_us: int
    given: Given | None
    """The newest command of the operator it names that the guard had heard."""
    ranges: dict[str, tuple[Range, int]]
    """By sensor: the newest reading, and when its ping was sent."""


class Heard(NamedTuple):
    """A reading that a guard was handed."""

    reading: Range
    at_us: int
    born_us: int


class Grant(NamedTuple):
    """A lease as a guard gave it; of nobody where it ended."""

    at_us: int
    holder: str
    counter: int


class Neutral:
    """For how long an operator's hand was neutral, at its own times."""

    def __init__(self) -> None:
        self._spans: list[tuple[int, int]] = []

    def note(self, born_us: int, *, is_neutral: bool) -> None:
        if not is_neutral:
            self._spans.append((born_us, -1))
        elif self._spans and self._spans[-1][1] >= 0 and born_us - self._spans[-1][1] <= _LONGEST_GAP_US:
            self._spans[-1] = (self._spans[-1][0], born_us)
        else:
            self._spans.append((born_us, born_us))
        if len(self._spans) > 1 and self._spans[-1][1] == self._spans[-2][1] == -1:
            self._spans.pop()

    def longest_since(self, us: int) -> int:
        """The longest span within what came after `us`."""
        return max((last - max(first, us) for first, last in reversed(self._spans) if last > us), default=0)


class Ledger(Observer):
    """Keeps what the judge asks for."""

    def __init__(self, agenda: EventQueue, true_input: TrueInput, report: type[BoardReport]) -> None:
        """`report`: the base board's."""
        self._report = report
        self._agenda = agenda
        self.true_input = true_input
        """What the operators truly do."""
        self._boots: dict[BoardKind, list[int]] = {kind: [0] for kind in BoardKind}
        self._measured: dict[Process, int] = {}
        self._typed: set[Process] = set()
        self._given: dict[Made, Given] = {}
        self._born: dict[Made, int] = {}  # of ranges, by maker and sensor
        self._ranges_of: dict[Process, dict[str, tuple[Range, int]]] = defaultdict(dict)
        self._newest_of: dict[Process, dict[str, Given]] = defaultdict(dict)
        self._passed: dict[Made, Passed] = {}
        self._heard_by_base: dict[Process, deque[tuple[int, Passed]]] = defaultdict(deque)
        self._read_us: dict[Process, int] = {}
        self.reported_us: dict[Process, int] = defaultdict(int)
        """By process of base: for how long its board's reports have come steadily, gaps left out."""
        self.readings: dict[str, deque[Heard]] = defaultdict(lambda: deque(maxlen=3))
        """By sensor: the last ones that any guard was handed."""
        self.neutral: dict[str, Neutral] = defaultdict(Neutral)
        """By operator's instance: for how long it has truly asked for nothing, and said so."""
        self.leases: dict[str, list[Grant]] = defaultdict(list)
        """By guard's instance: what it has granted and ended."""

    def on_reset(self, kind: BoardKind) -> None:
        """A board begins anew: so does its clock."""
        self._boots[kind].append(self._agenda.now_us)

    def is_of_this_boot(self, kind: BoardKind, boot_id: int) -> bool:
        """Whether a board has not been reset since it had this boot."""
        return boot_id == len(self._boots[kind])

    def held(self, process: Process, acceleration: Vector) -> None:
        self.true_input.hold(process.instance, acceleration, self._agenda.now_us)

    def clutched(self, process: Process) -> None:
        """The button of the joystick of `process` is pressed just now."""
        self.true_input.clutch(process.instance, self._agenda.now_us)

    def typed(self, process: Process, keys: bytes) -> None:
        self.true_input.press(process.instance, keys, self._agenda.now_us)
        self._typed.add(process)
        self._measured[process] = self._agenda.now_us

    def read(self, process: Process, frame: Frame) -> None:
        if isinstance(frame, TiltFrame):
            self._measured[process] = self._boot_us(BoardKind.JOYSTICK, frame.boot_id) + frame.board_us
        elif isinstance(frame, RangeFrame):
            self._measured[process] = self._boot_us(BoardKind.RANGER, frame.boot_id) + frame.board_us
        elif isinstance(frame, self._report):
            last_us, self._read_us[process] = self._read_us.get(process), self._agenda.now_us
            if last_us is not None and self._agenda.now_us - last_us <= _STEADY_US:
                self.reported_us[process] += self._agenda.now_us - last_us

    def said(self, process: Process, sample: Any) -> None:
        match sample:
            case DriveCommand():
                self._on_given(process, sample)
            case GuardedCommand():
                self._on_passed(process, sample)
            case Range():
                self._born[f"{sample.instance}/{sample.sensor}", sample.seq] = self._measured[process]
            case Lease():
                grants = self.leases[sample.instance]
                if not grants or grants[-1][1:] != (sample.holder, sample.counter):
                    grants.append(Grant(self._agenda.now_us, sample.holder, sample.counter))
                    self.on_grant(sample)
            case BaseState():
                self.on_base_state(process, sample)

    def heard(self, process: Process, sample: Any) -> None:
        match sample:
            case DriveCommand():
                given = self._given[sample.instance, sample.seq]
                newest = self._newest_of[process].get(sample.instance)
                if newest is None or sample.seq > newest.command.seq:
                    self._newest_of[process][sample.instance] = given
            case Range():
                self._on_range(process, sample)
            case GuardedCommand():
                self._heard_by_base[process].append((self._agenda.now_us, self.passed(sample)))
                self.on_guarded(process, sample)
            case EStopEngage():
                self.on_engage(process, sample)
            case EStopReset():
                self.on_reset_asked(sample)

    def passed(self, command: GuardedCommand) -> Passed:
        """What a guard's command stands on."""
        return self._passed[command.instance, command.seq]

    def heard_by_base(self, base: Process) -> Iterator[Passed]:
        """What it was handed lately, newest first."""
        heard = self._heard_by_base[base]
        while heard and self._agenda.now_us - heard[0][0] > _HEARD_US:
            heard.popleft()
        return (passed for _, passed in reversed(heard))

    # What a judge listens to.

    def on_grant(self, lease: Lease) -> None:
        """A guard has given the lease to another, or ended it."""

    def on_base_state(self, base: Process, state: BaseState) -> None:
        """Base tells of itself."""

    def on_guarded(self, base: Process, command: GuardedCommand) -> None:
        """Base is handed a command of a guard."""

    def on_engage(self, process: Process, asked: EStopEngage) -> None:
        """Base is asked to stop."""

    def on_reset_asked(self, asked: EStopReset) -> None:
        """Base is asked to release."""

    def _on_given(self, process: Process, sample: DriveCommand) -> None:
        born_us = self._measured.get(process, self._agenda.now_us)
        if process in self._typed and sample.neutral:
            born_us = self._agenda.now_us  # a key that is not pressed is so at every moment
        self._given[sample.instance, sample.seq] = Given(sample, born_us)
        is_neutral = sample.source == "hand" and self.true_input.is_neutral(sample.instance, born_us)
        self.neutral[sample.instance].note(born_us, is_neutral=is_neutral)

    def _on_passed(self, process: Process, sample: GuardedCommand) -> None:
        self._passed[sample.instance, sample.seq] = Passed(
            command=sample,
            at_us=self._agenda.now_us,
            given=self._newest_of[process].get(sample.operator),
            ranges=dict(self._ranges_of[process]),
        )

    def _on_range(self, process: Process, sample: Range) -> None:
        born_us = self._born[f"{sample.instance}/{sample.sensor}", sample.seq]
        known = self._ranges_of[process].get(sample.sensor)
        if known is None or born_us > known[1]:
            self._ranges_of[process][sample.sensor] = (sample, born_us)
            self.readings[sample.sensor].append(Heard(sample, self._agenda.now_us, born_us))

    def _boot_us(self, kind: BoardKind, boot_id: int) -> int:
        return self._boots[kind][boot_id - 1]
