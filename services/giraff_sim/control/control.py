"""The control socket: how tests and `giraff run` look into the simulated robot and lay hands on it."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import msgspec

from giraff_schemas.text import plain
from giraff_schemas.wire import BoardKind, DriveState, Latch, Refusal, ResetCause, WheelsFrame, Wiring
from giraff_sim.bodies.wheels.body import LEFT, RIGHT, WheelsBody
from giraff_sim.control import messages
from giraff_sim.ptys import SerialPort
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.world.body import BoardReport
from giraff_sim.world.hand import Hand, ScriptError, StillHand
from giraff_sim.world.room import Pose, RoomError

_HIGHEST: Final = 2.0  # m; no robot is higher
_WHEELS: Final[dict[messages.Wheel, int]] = {"left": LEFT, "right": RIGHT}

HandMaker = Callable[[str, float], Hand]
"""Makes a hand of its name ("demo", "still", a path) and the simulated second at which it begins."""


class Control:
    """Does what requests ask."""

    def __init__(
        self,
        simulation: Simulation,
        ports: Mapping[BoardKind, SerialPort],
        pacer: WallPacer,
        make_hand: HandMaker,
    ) -> None:
        self._simulation = simulation
        self._ports = ports
        self._pacer = pacer
        self._make_hand = make_hand
        self._decoder = msgspec.json.Decoder(messages.AnyRequest)
        self._actions: dict[type[messages.Request], Callable[[Any], messages.Reply | None]] = {
            messages.Now: lambda _request: None,
            messages.GetState: self._state,
            messages.GetRoom: self._room,
            messages.GetTruth: self._truth,
            messages.GetRecord: self._record,
            messages.Tilt: self._tilt,
            messages.SetHand: self._hand,
            messages.Button: self._button,
            messages.Place: self._place,
            messages.AddWall: self._add_wall,
            messages.RemoveWall: self._remove_wall,
            messages.FailBno055: self._fail_bno055,
            messages.FailSonar: self._fail_sonar,
            messages.CutBumper: self._cut_bumper,
            messages.CutEncoder: self._cut_encoder,
            messages.SlipEncoder: self._slip_encoder,
            messages.FlickerEncoder: self._flicker_encoder,
            messages.CutSignal: self._cut_signal,
            messages.BlockWheel: self._block_wheel,
            messages.BrakeWheel: self._brake_wheel,
            messages.Rewire: self._rewire,
            messages.Battery: self._battery,
            messages.Push: self._push,
            messages.Unplug: self._unplug,
            messages.Plug: self._plug,
            messages.Reset: self._reset,
        }

    def answer(self, line: bytes) -> messages.Reply:
        """The reply to one line."""
        try:
            request = self._decoder.decode(line)
            reply = self._actions[type(request)](request)
        except msgspec.DecodeError as error:
            return messages.Reply(ok=False, error=f"not a request: {plain(error)}")
        except (ValueError, RoomError, ScriptError) as error:
            return messages.Reply(ok=False, error=str(error))
        return reply or messages.Reply(ok=True, now_us=self._simulation.now_us)

    def _state(self, _request: messages.GetState) -> messages.Reply:
        simulation, plant = self._simulation, self._simulation.world.plant
        state = messages.State(
            now_us=simulation.now_us,
            x=plant.pose.x,
            y=plant.pose.y,
            yaw=plant.pose.yaw,
            left_speed=plant.left.speed,
            right_speed=plant.right.speed,
            speed=plant.speed,
            turn=plant.turn,
            lean=plant.lean,
            pivot=plant.pivot,
            room_version=simulation.world.room.version,
            path_length=plant.path_length,
            clearance=_finite(plant.clearance),
            closest=_finite(plant.closest),
            contacts=plant.contacts,
            battery_volts=plant.volts,
            skew=self._pacer.skew,
            pings={number: sonar.pings for number, sonar in simulation.world.sonars.items()},
            boards={kind.name.lower(): self._board_state(kind) for kind in simulation.boards},
            base=_base_says(simulation.record.telemetry),
            balance=simulation.world.body.balance,
            drawn=simulation.world.body.drawn,
        )
        return messages.Reply(ok=True, now_us=simulation.now_us, state=state)

    def _board_state(self, kind: BoardKind) -> messages.BoardState:
        board = self._simulation.boards[kind]
        port = self._ports.get(kind)
        return messages.BoardState(
            state=board.state,
            plugged=port is not None and port.is_plugged,
            resets=board.model.resets,
            sent=board.model.tx_total,
            taken=board.model.rx_total,
            lost=board.model.tx_lost + (port.lost if port else 0),
            complaints=board.model.errors,
            complaint=board.message,
        )

    def _room(self, _request: messages.GetRoom) -> messages.Reply:
        room = self._simulation.world.room
        surfaces = messages.Surfaces(version=room.version, walls=room.walls, posts=room.posts)
        return messages.Reply(ok=True, now_us=self._simulation.now_us, room=surfaces)

    def _truth(self, _request: messages.GetTruth) -> messages.Reply:
        return messages.Reply(ok=True, now_us=self._simulation.now_us, truth=self._simulation.world.truth)

    def _record(self, request: messages.GetRecord) -> messages.Reply:
        now_us = self._simulation.now_us
        until_us = now_us if request.until_us is None else request.until_us
        if until_us < request.since_us:
            raise ValueError(f"the window ends at {until_us} us, before it begins at {request.since_us} us")
        verdict = self._simulation.record.window(request.since_us, until_us)
        return messages.Reply(ok=True, now_us=now_us, record=verdict)

    def _tilt(self, request: messages.Tilt) -> None:
        self._simulation.world.hand = StillHand((request.x, request.y, request.z))

    def _hand(self, request: messages.SetHand) -> None:
        self._simulation.world.hand = self._make_hand(request.hand, self._simulation.now_us * 1e-6)

    def _button(self, request: messages.Button) -> None:
        self._simulation.world.button = request.pressed

    def _place(self, request: messages.Place) -> None:
        self._simulation.world.plant.place(Pose(request.x, request.y, request.yaw))

    def _add_wall(self, request: messages.AddWall) -> None:
        self._simulation.world.room.add_wall(request.name, request.points, closed=request.closed)

    def _remove_wall(self, request: messages.RemoveWall) -> None:
        self._simulation.world.room.remove(request.name)

    def _fail_bno055(self, request: messages.FailBno055) -> None:
        if self._simulation.bno055 is None:
            raise ValueError("there is no joystick here")
        self._simulation.bno055.fault = request.fault

    def _fail_sonar(self, request: messages.FailSonar) -> None:
        sonars = self._simulation.world.sonars
        if request.number not in sonars:
            raise ValueError(f"there is no sonar {request.number}; there are {sorted(sonars)}")
        if not 0.0 <= request.wild_share <= 1.0:
            raise ValueError(f"wild_share is {request.wild_share}: it must be in 0..1")
        sonars[request.number].fault = request.fault
        sonars[request.number].wild_share = request.wild_share

    def _cut_bumper(self, request: messages.CutBumper) -> None:
        bumpers = self._simulation.world.bumpers
        if request.number not in bumpers:
            raise ValueError(f"there is no bumper {request.number}; there are {sorted(bumpers)}")
        bumpers[request.number].is_cut = request.cut

    def _cut_encoder(self, request: messages.CutEncoder) -> None:
        self._wired_wheels.cut_encoder(_WHEELS[request.wheel], is_cut=request.cut)

    def _slip_encoder(self, request: messages.SlipEncoder) -> None:
        self._wheels.slip_encoder(_WHEELS[request.wheel], request.lost_share)

    def _flicker_encoder(self, request: messages.FlickerEncoder) -> None:
        self._wired_wheels.flicker_encoder(_WHEELS[request.wheel], flickers=request.flickers)

    def _cut_signal(self, request: messages.CutSignal) -> None:
        self._wired_wheels.cut_signal(_WHEELS[request.wheel], is_cut=request.cut)

    def _block_wheel(self, request: messages.BlockWheel) -> None:
        self._wheels.block_wheel(_WHEELS[request.wheel], is_blocked=request.blocked)

    def _brake_wheel(self, request: messages.BrakeWheel) -> None:
        if not (math.isfinite(request.brake) and request.brake >= 0.0):
            raise ValueError(f"nothing holds a wheel back by {request.brake} m/s²")
        self._wheels.brake_wheel(_WHEELS[request.wheel], request.brake)

    def _rewire(self, request: messages.Rewire) -> None:
        self._wired_wheels.rewire(Wiring(request.wiring))

    def _battery(self, request: messages.Battery) -> None:
        if not (math.isfinite(request.volts) and request.volts >= 0.0):
            raise ValueError(f"a battery cannot have {request.volts} V")
        self._simulation.world.plant.open_volts = request.volts

    def _push(self, request: messages.Push) -> None:
        if not (math.isfinite(request.impulse) and 0.0 <= request.height <= _HIGHEST):
            raise ValueError(f"nobody pushes by {request.impulse} N s at {request.height} m above the axle")
        self._simulation.world.body.push(request.impulse, request.height)

    def _unplug(self, request: messages.Unplug) -> None:
        self._ports[self._board(request.board)].unplug()

    def _plug(self, request: messages.Plug) -> None:
        self._ports[self._board(request.board)].plug()

    def _reset(self, request: messages.Reset) -> None:
        self._simulation.reset(self._board(request.board), ResetCause[request.cause.upper()])

    @property
    def _wheels(self) -> WheelsBody:
        body = self._simulation.world.body
        if isinstance(body, WheelsBody):
            return body
        raise ValueError("this robot has no two wheels with a motor each")

    @property
    def _wired_wheels(self) -> WheelsBody:
        if BoardKind.BASE not in self._simulation.boards:
            raise ValueError("there is no base board here")
        return self._wheels

    def _board(self, name: str) -> BoardKind:
        kind = BoardKind[name.upper()]
        if kind not in self._ports:
            raise ValueError(f"there is no {name} board here")
        return kind


def _base_says(frame: BoardReport | None) -> messages.BaseSays | None:
    if not isinstance(frame, WheelsFrame):
        return None
    return messages.BaseSays(
        boot_id=frame.boot_id,
        session=frame.session,
        drive_state=DriveState(frame.drive_state).name.lower(),
        latch=Latch(frame.latch).name.lower(),
        last_refusal=Refusal(frame.last_refusal).name.lower(),
        left_ticks=frame.left_ticks,
        right_ticks=frame.right_ticks,
        left_pwm_counts=frame.left_pwm_counts,
        right_pwm_counts=frame.right_pwm_counts,
        accepted=frame.accepted,
        refused=frame.refused,
        line_errors=frame.line_errors,
    )


def _finite(value: float) -> float:
    """JSON has no infinity; no room is this wide."""
    return min(value, 1e9)
