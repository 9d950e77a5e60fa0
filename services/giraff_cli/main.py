"""The `giraff` command: its verbs. What they do is imported when it is asked for."""

from __future__ import annotations

import typer

from giraff_cli.calibrate.commands import calibrate
from giraff_cli.camera.commands import camera
from giraff_cli.check.commands import check
from giraff_cli.commission.commands import commission
from giraff_cli.doctor.commands import doctor
from giraff_cli.drive.commands import drive
from giraff_cli.dst.commands import dst
from giraff_cli.encoder.commands import encoder
from giraff_cli.estop.commands import estop
from giraff_cli.frames.commands import frames
from giraff_cli.graph.commands import graph
from giraff_cli.keys.commands import keys
from giraff_cli.localize.commands import localize
from giraff_cli.logs.commands import logs
from giraff_cli.map.commands import maps
from giraff_cli.motion.commands import arc, go, move, turn
from giraff_cli.node.commands import node
from giraff_cli.odom.commands import odom
from giraff_cli.options import NEGATIVE
from giraff_cli.param.commands import param
from giraff_cli.play.commands import play
from giraff_cli.record.commands import record
from giraff_cli.replay.commands import replay
from giraff_cli.run.commands import run
from giraff_cli.top.commands import top
from giraff_cli.topic.commands import topic
from giraff_cli.tune.commands import tune
from giraff_cli.view.commands import view
from giraff_cli.vision.commands import vision
from giraff_cli.watch.commands import watch
from giraff_cli.web.commands import web
from giraff_cli.why.commands import why

app = typer.Typer(
    name="giraff",
    help="A masterless multi-machine robot.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for verb in (
    record,
    play,
    replay,
    graph,
    frames,
    top,
    view,
    doctor,
    run,
    logs,
    why,
    watch,
    drive,
    web,
    localize,
    vision,
):
    app.command()(verb)
app.command()(dst)
app.command()(commission)
for motion in (move, turn, arc):
    app.command(context_settings=NEGATIVE)(motion)
app.command(context_settings=NEGATIVE)(go)
for name, verbs in (
    ("estop", estop),
    ("calibrate", calibrate),
    ("camera", camera),
    ("check", check),
    ("encoder", encoder),
    ("keys", keys),
    ("map", maps),
    ("topic", topic),
    ("node", node),
    ("param", param),
    ("odom", odom),
    ("tune", tune),
):
    app.add_typer(verbs, name=name)


@app.callback()
def giraff() -> None:
    """A masterless multi-machine robot."""
