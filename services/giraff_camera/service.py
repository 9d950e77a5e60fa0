"""What a camera sees, to those who look at it: `camera/<name>/@full` and `@small`."""

from collections import deque
from collections.abc import Callable
from typing import Final, Protocol

from giraff_camera.config import CameraConfig, camera_of
from giraff_camera.device.image import Image
from giraff_camera.jpeg import JpegEncoder, half
from giraff_camera.policy import PicturePolicy
from giraff_core.io import IO, Publisher, Selectable
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_schemas.camera import CameraState, Picture, PictureSize
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import CAMERA, CAMERA_ON, CAMERA_SMALL, CAMERA_STATE, TICK
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TICKS: Final = 200
"""Number of ticks that are kept: 4 s of them, longer than a picture takes from its exposure to here."""
_MEASURE_HZ: Final = 1.0
"""Hz. A full picture is encoded so often to know its bytes, while nobody is sent one."""


class Capture(Selectable, Protocol):
    """A camera in a thread of its own. Its descriptor is readable when a picture has come."""

    @property
    def fault(self) -> Trouble:
        """Why there are no pictures though it was started; NO_TROUBLE: there are, or may be."""
        ...

    @property
    def rate(self) -> float:
        """Hz; pictures of the last second."""
        ...

    @property
    def is_stuck(self) -> bool:
        """The device does not come back from a read, and only the process's end frees it."""
        ...

    def start(self) -> None:
        """Open the device, and again whenever it is lost; nothing where that is so already."""
        ...

    def stop(self) -> None:
        """Close the device."""
        ...

    def pop_picture(self) -> Image | None:
        """The newest picture that was not taken yet."""
        ...


class Camera:
    """One camera. It is open while somebody looks, and only then."""

    def __init__(
        self,
        io: IO,
        config: CameraConfig,
        robot: RobotConfig,
        capture: Capture,
        log: Callable[[str], None],
    ) -> None:
        """`log`: takes a line for people: who looks. Raises ValueError where the robot file has no such camera."""
        self._io, self._capture, self._log = io, capture, log
        self.name, self._model = camera_of(config, robot)
        self._max_bytes = config.max_bytes
        self._policy = PicturePolicy(self.name, io.instance, config.rate, config.max_bytes)
        self._encoders: dict[PictureSize, JpegEncoder] = {
            "full": JpegEncoder(config.quality),
            "small": JpegEncoder(config.quality),
        }
        self._ticks_heard = io.inbox(TICK)
        self._holds = io.inbox(CAMERA_ON.at(self.name))
        self._states = io.publisher(CAMERA_STATE.at(self.name))
        self._pictures: dict[PictureSize, Publisher[Picture]] = {
            "full": io.publisher(CAMERA.at(self.name)),
            "small": io.publisher(CAMERA_SMALL.at(self.name)),
        }
        self._sent: dict[PictureSize, int] = {"full": 0, "small": 0}
        self._stated = 0
        io.frame((transform := self._model.transform(self.name)).child, transform)
        self._ticks: deque[tuple[float, RobotTime]] = deque(maxlen=_TICKS)
        self._state_timer, self._measure_timer = Timer(CAMERA_STATE.rate_hz), Timer(_MEASURE_HZ)
        self.timers = (self._state_timer,)
        self.link = capture
        self._image: Image | None = None
        self._unsent: set[PictureSize] = set()
        self._known: dict[str, str] = {}

    def turn(self, now: float) -> None:
        policy = self._policy
        self._ticks.extend((now, tick.time) for tick in self._ticks_heard.pop_all())
        for hold in self._holds.pop_all():
            policy.on_hold(hold, now)
        policy.update(now)
        if policy.is_on:
            self._capture.start()
            self._show(now)
        else:
            self._capture.stop()
            self._image = None
        if self._capture.is_stuck:
            raise RuntimeError("the camera does not come back from a read: a new process tries it again")
        if self._state_timer.due(now):
            self._tell_who_looks()
            self._state(now)

    def end(self) -> None:
        self._capture.stop()

    def _show(self, now: float) -> None:
        if (image := self._capture.pop_picture()) is not None:
            self._image, self._unsent = image, {"full", "small"}
        image = self._image
        if image is None:
            return
        due = self._policy.due(now)
        if "full" not in due and self._measure_timer.due(now):
            self._policy.full_bytes = len(self._encoders["full"].encode(image.pixels, self._max_bytes))
        for size, limit in due.items():
            if size in self._unsent:
                self._unsent.discard(size)
                self._send(image, size, limit, now)

    def _send(self, image: Image, size: PictureSize, limit: int, now: float) -> None:
        pixels = image.pixels if size == "full" else half(image.pixels)
        encoder = self._encoders[size]
        jpeg = encoder.encode(pixels, limit)
        width, height = encoder.size
        at, tick = self._tick_at(image.taken)
        picture = Picture(
            camera=self.name,
            jpeg=jpeg,
            width=width,
            height=height,
            tick=tick,
            exposure=image.exposure,
            since_tick=max(0.0, image.taken - at),
        )
        self._pictures[size].put(picture)
        self._policy.sent(size, self._sent[size], len(jpeg), now)
        self._sent[size] += 1
        if size == "full":
            self._policy.full_bytes = len(jpeg)

    def _tick_at(self, taken: float) -> tuple[float, RobotTime | None]:
        """The newest tick that this host held when the exposure began, and when it had come."""
        return next(((at, tick) for at, tick in reversed(self._ticks) if at <= taken), (taken, None))

    def _state(self, now: float) -> None:
        trouble = self._capture.fault if self._policy.is_on else NO_TROUBLE
        self._io.set_fault("camera", trouble)
        self._states.put(
            CameraState(
                camera=self.name,
                askers=self._policy.askers(),
                width=self._model.width,
                height=self._model.height,
                rate=self._capture.rate if self._policy.is_on else 0.0,
                reason=trouble,
            )
        )
        self._policy.on_state_sent(self._stated, now)
        self._stated += 1

    def _tell_who_looks(self) -> None:
        looking = {asker.instance: asker.by for asker in self._policy.askers()}
        for instance, by in looking.items():
            if self._known.get(instance) != by:
                self._log(f"{by} looks at {self.name}")
        for instance, by in self._known.items():
            if instance not in looking:
                self._log(f"{by} looks at {self.name} no longer")
        self._known = looking
