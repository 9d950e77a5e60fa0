"""A robot both of whose encoders lose half of their counts. A camera sees it, judged by the truth of its world."""

import math
from typing import Final

import cv2
import numpy as np

from giraff_core.io import IO
from giraff_core.kinematics.differential_drive import CREEP
from giraff_core.senses import Camera
from giraff_core.timer import Timer
from giraff_schemas.camera import Picture
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import ODOM, TICK, VISUAL_ODOM
from giraff_sim.bodies.wheels.body import LEFT, RIGHT
from giraff_sim.camera.renderer import Renderer
from giraff_sim.camera.scene import Scene
from giraff_sim.world.world import World
from giraff_vision.ground import Grey
from giraff_vision.policy import VisionPolicy
from tests.loop.loops import FULL_TILT, SEES, arm, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.filmed_drive import RATE
from tests.support.wheels import wheels_of

CAMERA: Final = SEES.robot.of(Camera)["head"]


class Eye:
    """Camera and vision in one: what each picture tells comes with the next one."""

    link = None

    def __init__(self, io: IO, world: World) -> None:
        self._world, self._policy = world, VisionPolicy(CAMERA)
        self._renderer = Renderer(CAMERA, Scene("planks"))
        self._odometry, self._ticks, self._out = io.inbox(ODOM), io.inbox(TICK), io.publisher(VISUAL_ODOM)
        self._tick: RobotTime | None = None
        self._ticked, self._number = 0.0, 0
        self._taken: tuple[Picture, Grey] | None = None
        self._timer = Timer(RATE)
        self.timers = (self._timer,)

    def turn(self, now: float) -> None:
        for tick in self._ticks.pop_all():
            self._tick, self._ticked = tick.time, now
        for odometry in self._odometry.pop_all():
            self._policy.on_odometry(odometry)
        if self._tick is None or not self._timer.due(now):
            return
        if self._taken is not None:
            self._out.put(self._policy.on_picture(*self._taken))
        self._number += 1
        since, plant = now - self._ticked, self._world.plant
        picture = Picture(
            camera="head", seq=self._number, jpeg=b"", width=320, height=240, tick=self._tick, since_tick=since
        )
        seen = self._renderer.frame(plant.pose, now, speed=plant.speed)
        self._taken = picture, np.asarray(cv2.cvtColor(seen, cv2.COLOR_BGR2GRAY), np.uint8)

    def end(self) -> None:
        pass


def test_a_camera_sees_that_both_encoders_lose_counts() -> None:
    with closed_loop(proving_room(), SEES) as loop:
        arm(loop)
        world = loop.simulation.world
        world.room.remove("walls")
        for wheel in (LEFT, RIGHT):
            wheels_of(world).slip_encoder(wheel, 0.5)
        loop.launch("vision", lambda process: Eye(process, world), loop.hosts["robot"])
        hold(loop, x=FULL_TILT)
        began, fastest = loop.simulation.now_us, 0.0
        doubted = math.inf
        while loop.simulation.now_us - began < 1_950_000:
            loop.step()
            fastest = max(fastest, world.plant.speed)
            if "encoders of both" in str(loop.newest["base"].reason):
                doubted = min(doubted, (loop.simulation.now_us - began) * 1e-6)
        print(f"{fastest:.2f} m/s at most, doubted after {doubted:.2f} s, {world.plant.speed:.2f} m/s then")
        assert world.plant.speed <= 1.2 * CREEP
        assert "slowed: encoders of both wheels" in str(loop.newest["base"].reason)
