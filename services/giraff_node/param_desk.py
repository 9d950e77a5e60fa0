"""Where the parameters of a service are asked for: in its loop's turns, and what is saved in a thread of its own."""

from __future__ import annotations

import logging
import socket
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Generic

import msgspec

from giraff_node.config import ConfigT
from giraff_node.inbox import Asked, Inbox
from giraff_node.params import ParamError, Params
from giraff_node.state import write_file_durably
from giraff_schemas.params import ParamAnswer, ParamDescribe, ParamSave, ParamSet

PARAMS_FOLDER: Final = "params"
"""Below the state directory: a file for each service that has saved something."""

Describes = Inbox[Asked[ParamDescribe, ParamAnswer]]
Sets = Inbox[Asked[ParamSet, ParamAnswer]]
Saves = Inbox[Asked[ParamSave, ParamAnswer]]


class ParamDesk(Generic[ConfigT]):
    """`folder`: the state directory."""

    def __init__(self, service: str, instance: str, params: Params[ConfigT], folder: Path, log: logging.Logger) -> None:
        self.fault = ""
        """What of the saved parameters does not count, with the way out; empty: all of it does."""
        self._service, self._instance = service, instance
        self._params, self._log = params, log
        self._file = folder / PARAMS_FOLDER / f"{service}.json"
        self._saver: threading.Thread | None = None
        self._restore()

    def turn(
        self, describes: Describes, sets: Sets, saves: Saves, reconfigure: Callable[[ConfigT], None] | None
    ) -> None:
        """Answer what has come. `reconfigure` takes what is in force from now on; None: nothing can be set."""
        for asked in describes.take():
            asked.answer(self._answer(""))
        for to_set in sets.take():
            to_set.answer(self._set(to_set.request, reconfigure))
        # A disk that hangs must not hold up the loop; nor may those who ask meanwhile have a thread each.
        if (self._saver is None or not self._saver.is_alive()) and (to_save := tuple(saves.take())):
            self._saver = threading.Thread(target=self._save_each, args=(to_save,), name="params", daemon=True)
            self._saver.start()

    def _set(self, request: ParamSet, reconfigure: Callable[[ConfigT], None] | None) -> ParamAnswer:
        if reconfigure is None:
            return self._answer(f"{self._service} takes the robot file and a restart for each of its parameters")
        try:
            self._params.set(request.name, request.value)
        except ParamError as error:
            return self._answer(str(error))
        reconfigure(self._params.config)
        self._log.info("%s is %s, by %s", request.name, getattr(self._params.config, request.name), request.by)
        return self._answer("", request.name)

    def _save_each(self, waiting: tuple[Asked[ParamSave, ParamAnswer], ...]) -> None:
        for asked in waiting:
            asked.answer(self._save(asked.request))

    def _save(self, request: ParamSave) -> ParamAnswer:
        try:
            kept = self._params.to_save(request.names)
            self._file.parent.mkdir(parents=True, exist_ok=True)
            write_file_durably(self._file, msgspec.json.format(msgspec.json.encode(kept)) + b"\n")
        except ParamError as error:
            return self._answer(str(error))
        except OSError as error:
            return self._answer(
                f"{self._file}: {error.strerror}; the value counts until a restart: make the folder writable "
                f"(STATE_DIRECTORY names it), or write it into the robot file"
            )
        self._params.saved = kept
        self._log.info("saved in %s, by %s: %s", self._file, request.by, kept)
        return self._answer("", *(request.names or kept))

    def _restore(self) -> None:
        try:
            saved = msgspec.json.decode(self._file.read_bytes(), type=dict[str, Any])
        except FileNotFoundError:
            return
        except OSError as error:
            self.fault = f"{self._file}: {error.strerror}; what was saved there does not count"
            return
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            self.fault = f"{self._file} is damaged ({error}), and does not count; set and save again, or remove it"
            return
        ignored = self._params.restore(saved)
        if self._params.saved:
            self._log.info("as saved in %s, not as in the robot file: %s", self._file, self._params.saved)
        if ignored:
            self.fault = f"{self._file}: {'; '.join(ignored)}; save again, or remove the file"

    def _answer(self, reason: str, *names: str) -> ParamAnswer:
        return ParamAnswer(
            service=self._service,
            instance=self._instance,
            host=socket.gethostname(),
            done=not reason,
            reason=reason,
            params=() if reason else self._params.describe(names),
        )
