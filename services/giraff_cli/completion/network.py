"""What the robots of the network have, for a shell."""

from __future__ import annotations

import time
from collections.abc import Sequence

from giraff_node.network.discovery import resolve_target
from giraff_node.network.replies import gather_answers
from giraff_node.network.session import open_session
from giraff_node.network.tokens import find_tokens, list_robots
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.health import Health
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import ANSWERING
from giraff_schemas.topics import PARAM_DESCRIBE, ROOT, alive_key, health_key


def asked(source: str, robot: str | None, connect: Sequence[str], word: str, deadline: float) -> list[str]:
    """Return robots, services, published topics or parameters. Raises what opening a session raises.

    Only a name that somebody has typed narrows it to one robot. The process ends without closing the session.
    """
    way = resolve_target(robot, connect)
    session = open_session(way.network, way.robot or "*", "client")
    within = max(0.05, deadline - time.monotonic())
    if source == "robots":
        return list_robots(session)
    whose = way.robot if way.robot and not way.named_by else "*"
    if source == "services" or (source in {"params", "settable"} and "." not in word):
        services = [token.service for token in find_tokens(session, alive_key(whose), within)]
        return [each for each in services if source == "services" or each in ANSWERING]
    if source == "published":
        healths = gather_answers(session, health_key(whose), Health, within)
        return [key for health in healths for key in health.publishes]
    service = word.partition(".")[0]
    query = PARAM_DESCRIBE.at(service) if service in ANSWERING else PARAM_DESCRIBE
    at = f"{ROOT}/{whose}/{query.key}"
    request = {"payload": encode(ParamDescribe()), "encoding": encoding_of(ParamDescribe)}
    told = gather_answers(session, at, ParamAnswer, within, **request)
    return [
        param.name if param.name.startswith("robot.") else f"{answer.service}.{param.name}"
        for answer in told
        for param in answer.params
        if source == "params" or param.live != "fixed"
    ]
