"""A request of parameters without a network: its answer is kept."""

from typing import Any

from giraff_schemas.codec import encode
from giraff_schemas.params import ParamAnswer


class Asked:
    """As a request of `giraff_node.Node`, whose answer has to be encoded, too."""

    def __init__(self, request: Any) -> None:
        self.request = request
        self.said: ParamAnswer | None = None

    def answer(self, answer: ParamAnswer) -> None:
        encode(answer)
        self.said = answer
