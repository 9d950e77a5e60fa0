"""What a run tells of a camera that sees the robot move: in the summary, the live view and the line."""

from dataclasses import replace

import msgspec

from giraff_cli.run.screen import line
from giraff_cli.run.summary import to_json, to_text
from giraff_cli.run.telemetry import RunTelemetry
from giraff_schemas import topics
from giraff_telemetry.visual_odometry import VisualSummary
from tests.unit.cli.samples import MS, TYPES, Network, odometry, seen, ten_seconds, truth
from tests.unit.cli.test_shown import FRAME, SECOND, rendered, summary

END = 10_600
"""ms. Pictures come half a second after they were taken."""


def drive_seen(last: str = "", maker: str = "m") -> RunTelemetry:
    """A drive of 4 m at 0.4 m/s, seen from the second metre on: the camera tells 1 % too much of it, the wheels 2 %."""
    telemetry = RunTelemetry(TYPES, truth(0))
    network = Network(telemetry)
    for ms in range(0, END + 1, 10):
        x = min(0.4e-3 * ms, 4.0)
        network.send(topics.ODOM, odometry(ms * MS, 1.02 * x), ms * MS)
        shot = ms - 500
        if 5050 <= shot <= 10_000 and shot % 50 == 0:
            reason = {50: "dark", 100: "covered", 0: last}.get(shot % 1000, "")
            now, began = (maker, 5550) if shot > 5500 and maker != "m" else ("m", 5050)
            told = seen(shot * MS, 1.01 * 0.4e-3 * (shot - began), reason, 0.1, "light a fire")
            network.send(topics.VISUAL_ODOM, told, ms * MS, maker=now)
        if ms and ms % 200 == 0:
            telemetry.see(truth(ms * MS, x=x, speed=0.4))
    return telemetry


def test_the_summary_has_wheels_camera_and_truth_beside_each_other() -> None:
    told = summary(drive_seen())
    assert told.visual == VisualSummary(
        camera="head",
        pictures=99,
        measured_share=0.9091,
        reasons={"covered": 5, "dark": 4},
        without_wheels=99,
        path_m=1.9998,
        blind_m=0.1,
        true_m=1.98,
        error_m=0.0198,
        error_deg=0.5,
        wheels_m=2.0196,
        wheels_error_m=0.0396,
        wheels_error_deg=0.0,
    )
    assert msgspec.json.decode(to_json(told))["visual"]["reasons"] == {"covered": 5, "dark": 4}
    assert """
since a picture  truth 1.98 m, wheels 2.02 m, camera 2.00 m
  wheels off by  0.040 m, 0.00° (2.00% of the way)
  camera off by  0.020 m, 0.50° (1.00% of the way)
camera measures  90.9% of 99 pictures, all but 0.10 m of the way; else
                 5 covered
                 4 dark
                 nothing heard of the wheels at 99
""" in to_text(told)
    assert max(map(len, to_text(told).splitlines())) <= 80
    assert summary(ten_seconds()).visual is None
    restarted = summary(drive_seen(maker="another")).visual
    assert restarted is not None
    assert (restarted.pictures, restarted.true_m, restarted.error_m) == (89, 1.78, 0.0178)


def test_the_last_row_and_the_line_tell_whether_the_camera_sees_it_move() -> None:
    frame = replace(FRAME, services=FRAME.services | {"vision": "alive"}, look="see by it: giraff camera view")
    snapshot = drive_seen("dark").snapshot(END * MS)
    assert rendered(snapshot, frame)[-1].rstrip() == "VISION  dark  see by it: giraff camera view"
    assert rendered(snapshot, replace(frame, services={"vision": "ended"}))[-1].startswith("VISION  ended  see by it")
    assert line(drive_seen().snapshot(END * MS), 0.0).endswith(" | camera measures")
    assert line(drive_seen().snapshot(END * MS + 4 * SECOND), 0.0).endswith(
        " | camera unknown, vision was not heard for 4 s"
    )
