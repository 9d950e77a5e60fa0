"""Where a scene is sent: to a window, to browsers, or into a file."""

import os
import socket
from pathlib import Path
from typing import Any, Final

import rerun as rr

from giraff_core.robot import RobotConfig
from giraff_schemas.messages import Sample
from giraff_schemas.requests import EchoMap
from giraff_schemas.topics import Topic
from giraff_viewer.desk import TIMELINE, blueprint, camera_blueprint
from giraff_viewer.rows import Row
from giraff_viewer.scene import Scene
from giraff_viewer.window import ViewerError

_LOOK_EVERY: Final = 100_000_000  # ns
_SEND_EVERY: Final = 0.08  # s; smaller parcels cost the viewer more than what is in them
_FLUSH_WITHIN: Final = 5.0  # s


class Show:
    """Draws one robot. Times are ns since 1970, when each thing was heard."""

    def __init__(
        self, robot: RobotConfig, *, live: bool, camera: str = "", still: bool = False, note: str = ""
    ) -> None:
        """`camera`: whose pictures alone are shown; empty: all is. `still`: one picture is taken, of no window.

        `note`: as `Scene` has it.
        """
        self._live, self._still = live, still
        self._camera = camera
        self._blueprint = camera_blueprint(camera) if camera else blueprint(live=live, still=still)
        self._shown: tuple[bool, tuple[str, ...]] = (False, ())
        """What the screen shows: the plots of a robot that balances or not, and the cameras with a picture."""
        self.heard = 0
        """Samples."""
        self._scene = Scene(robot, note)
        batches = rr.ChunkBatcherConfig.LOW_LATENCY()
        batches.flush_tick = _SEND_EVERY
        self._stream = rr.RecordingStream(f"giraff {robot.name}", batcher_config=batches)
        self._now_ns = 0
        self._looked_ns = 0

    @property
    def newest(self) -> float:
        """s since 1970 of the newest that was drawn."""
        return self._now_ns * 1e-9

    def to_window(self, url: str) -> None:
        """Into a viewer that listens there."""
        self._stream.connect_grpc(url, default_blueprint=self._blueprint)
        self._begin()

    def to_file(self, path: Path) -> None:
        """Into a file that `rerun FILE` opens. Raises ViewerError."""
        try:
            path.open("wb").close()  # rerun itself would say nothing of a folder that is not there
            self._stream.save(path, default_blueprint=self._blueprint)
        except (OSError, RuntimeError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise ViewerError(f"{path} cannot be written: {reason}") from error
        self._begin()

    def to_browsers(self, port: int, data_port: int, memory: str) -> None:
        """Serve any browser that asks, at all addresses of this machine. Raises ViewerError."""
        require_free(port)
        require_free(data_port)
        try:
            self._stream.serve_grpc(
                grpc_port=data_port,
                default_blueprint=self._blueprint,
                server_memory_limit=memory,
                cors_allow_origin=[f"http://*:{port}"],
            )
            rr.serve_web_viewer(web_port=port, open_browser=False)
        except RuntimeError as error:
            raise ViewerError(f"no web viewer at port {port}: {error}") from error
        self._begin()

    def on_sample(self, topic: Topic[Any], sample: Sample, at_ns: int) -> None:
        """Draw what a sample changes."""
        self.heard += 1
        rows = self._scene.on_sample(topic, sample, at_ns)
        if (wanted := (self._scene.balances, self._scene.cameras)) != self._shown and not self._camera:
            if self._scene.balances and not self._shown[0]:
                self._log_static(self._scene.begin_balance())
            self._shown = wanted
            balances, cameras = wanted
            new = blueprint(live=self._live, balances=balances, cameras=cameras, still=self._still)
            self._stream.send_blueprint(new)
        self._log(rows, at_ns)

    def draw(self, robot: RobotConfig, at_ns: int) -> None:
        """Draw from now on by what the robot itself has told."""
        self._log(self._scene.clear(), at_ns)
        self._scene = Scene(robot)
        self._begin()

    def begin_with(self, earlier: EchoMap) -> None:
        """Take where echoes came from before anybody looked."""
        self._scene.begin_with(earlier)

    def on_liveliness(self, service: str, instance: str, at_ns: int, *, present: bool) -> None:
        """Tell that a service has come or gone."""
        self._log(self._scene.on_liveliness(service, instance, present=present), at_ns)

    def update(self, now_ns: int) -> None:
        """Draw what the time that passes changes; to be called often."""
        if not 0 <= now_ns - self._looked_ns < _LOOK_EVERY:
            self._looked_ns = now_ns
            self._log(self._scene.update(now_ns), now_ns)

    def flush(self) -> None:
        """Until all has been sent, and no longer than a viewer that hangs deserves. Raises ViewerError."""
        try:
            self._stream.flush(timeout_sec=_FLUSH_WITHIN)
        except (RuntimeError, TimeoutError) as error:
            raise ViewerError(f"not everything reached the viewer: {error}") from error

    def close(self) -> None:
        """The last word; a file is whole after it."""
        self.flush()
        self._stream.disconnect()

    def _begin(self) -> None:
        self._log_static(self._scene.begin())

    def _log_static(self, rows: list[Row]) -> None:
        for path, what in rows:
            self._stream.log(path, what, static=True)

    def _log(self, rows: list[Row], at_ns: int) -> None:
        if not rows:
            return
        self._now_ns = max(self._now_ns, at_ns)
        self._stream.set_time(TIMELINE, timestamp=at_ns * 1e-9)
        for path, what in rows:
            self._stream.log(path, what)


def require_screen() -> None:
    """ViewerError where no window could be seen."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ViewerError("no screen here, neither DISPLAY nor WAYLAND_DISPLAY is set; give --web, --save or --picture")


def require_free(port: int) -> None:
    """ViewerError where another program listens."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("", port))
        except OSError as error:
            raise ViewerError(f"port {port}: {error.strerror}; name another with --port") from error
