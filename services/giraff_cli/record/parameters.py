"""The parameters that `giraff record` keeps: those that the services go by, told by themselves."""

from __future__ import annotations

from collections import deque
from functools import partial
from typing import Any, Final

import zenoh

from giraff_mcap.raw_sample import RawSample
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tokens import Token, watch_tokens
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import ANSWERING
from giraff_schemas.topics import PARAM_DESCRIBE, key_of

_MOST: Final = 50  # processes that are asked at once; on an open network anybody may declare a name


class RecordedParameters:
    """Asks each process of the robot once, as soon as it is there. What is set later each service tells by itself."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        """`session`: of the recorder alone."""
        self._session, self._robot = session, robot
        self._news: deque[tuple[Token, bool]] = deque()  # of Zenoh's threads
        self._asking: dict[Token, QueryClient[ParamDescribe, ParamAnswer]] = {}
        self._tokens: Any = watch_tokens(session, robot, lambda *news: self._news.append(news))

    def pop_all(self, now: float, at_ns: int) -> list[RawSample]:
        """Ask further, and return the answers since the last call. `now`: s; `at_ns`: the same moment."""
        for _ in range(len(self._news)):
            token, present = self._news.popleft()
            if not present:
                self._asking.pop(token, None)
            elif token.service in ANSWERING and len(self._asking) < _MOST:
                self._asking[token] = QueryClient(
                    self._session,
                    self._robot,
                    PARAM_DESCRIBE.at(token.service),
                    ParamDescribe(),
                    partial(_is_of, token.instance),
                )
        answers = {token: answer for token, asking in self._asking.items() if (answer := asking.poll(now)) is not None}
        for token in answers:
            del self._asking[token]
        encoding = encoding_of(ParamAnswer)
        return [
            RawSample(at_ns, key_of(self._robot, PARAM_DESCRIBE.at(token.service)), encode(answer), encoding)
            for token, answer in answers.items()
        ]


def _is_of(instance: str, answer: ParamAnswer) -> bool:
    return answer.instance == instance
