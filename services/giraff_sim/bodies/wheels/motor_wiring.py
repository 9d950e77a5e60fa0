"""How motors and encoders are soldered to the base board, whatever its `configure` frame says."""

from __future__ import annotations

from typing import Final

from giraff_schemas.wire import Wiring

LEFT: Final = 0
RIGHT: Final = 1

_INVERT_MOTOR: Final = (Wiring.INVERT_LEFT_MOTOR, Wiring.INVERT_RIGHT_MOTOR)
_INVERT_ENCODER: Final = (Wiring.INVERT_LEFT_ENCODER, Wiring.INVERT_RIGHT_ENCODER)

Pair = tuple[float, float]


class MotorWiring:
    """Between the plant's wheels, by side, and the motors and encoders of board_model.h, by number."""

    def __init__(self) -> None:
        self.wiring = Wiring(0)
        """What `configure` must say for levels and ticks to be right."""
        self._is_crossed = False  # flags are slow to look at, and this is asked at each step
        self._starts: Pair = (0.0, 0.0)  # position of each encoder where its wheel's is 0

    def encoder_of(self, wheel: int) -> int:
        """The number of a wheel's encoder."""
        return wheel ^ int(Wiring.SWAP_ENCODERS in self.wiring)

    def motor_of(self, wheel: int) -> int:
        """Return the number of a wheel's motor."""
        return wheel ^ int(Wiring.SWAP_MOTORS in self.wiring)

    def duties(self, drives: Pair) -> Pair:
        """What each wheel gets of the motors' signed duties."""
        if not self._is_crossed:
            return drives
        swap = int(Wiring.SWAP_MOTORS in self.wiring)
        return self._signed(_INVERT_MOTOR, LEFT, drives[swap]), self._signed(_INVERT_MOTOR, RIGHT, drives[1 - swap])

    def positions(self, states: Pair) -> Pair:
        """Where each encoder is when the wheels are there, quadrature states."""
        if not self._is_crossed:
            return self._starts[0] + states[0], self._starts[1] + states[1]
        turned = [0.0, 0.0]
        for wheel in (LEFT, RIGHT):
            turned[self.encoder_of(wheel)] = self._signed(_INVERT_ENCODER, wheel, states[wheel])
        return self._starts[0] + turned[0], self._starts[1] + turned[1]

    def rewire(self, wiring: Wiring, states: Pair) -> None:
        """Rewire all, with the wheels where they are: no encoder moves."""
        before = self.positions(states)
        self.wiring, self._starts = wiring, (0.0, 0.0)
        self._is_crossed = bool(wiring)
        after = self.positions(states)
        self._starts = before[0] - after[0], before[1] - after[1]

    def _signed(self, inverted: tuple[Wiring, Wiring], wheel: int, value: float) -> float:
        return -value if inverted[wheel] in self.wiring else value
