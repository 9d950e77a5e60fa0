"""Answers parameter queries in the service's loop. No I/O: a `Store` writes the files."""

from collections import deque
from collections.abc import Callable
from typing import Any, Final, Generic

import msgspec

from giraff_core.io import Inbox, PendingQuery, Store
from giraff_core.parameters.table import ConfigT, MistypedError, ParamError, Parameters
from giraff_schemas.checks import require_sendable
from giraff_schemas.params import ParamAnswer, ParamDescribe, ParamSave, ParamSet
from giraff_schemas.text import brief, plain
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LONGEST: Final = 300  # characters of a fault: a file may hold anything
PARAMS_FOLDER: Final = "params"
"""Below the state directory: a file for each service that has saved something."""
_MAKE_WRITABLE: Final = "make the folder writable (STATE_DIRECTORY names it), or write it into the robot file"
_MOST_WAITING: Final = 20
"""Who ask to save while the disk hangs; the oldest goes without an answer."""

Describes = Inbox[PendingQuery[ParamDescribe, ParamAnswer]]
Sets = Inbox[PendingQuery[ParamSet, ParamAnswer]]
Saves = Inbox[PendingQuery[ParamSave, ParamAnswer]]


class ParameterServer(Generic[ConfigT]):
    """`service`, `instance` and `host` name who answers; `store` keeps what is saved."""

    def __init__(
        self,
        service: str,
        instance: str,
        host: str,
        params: Parameters[ConfigT],
        store: Store,
        log: Callable[..., None],
    ) -> None:
        self.fault = NO_TROUBLE
        """What of the saved parameters does not count."""
        self.lost = NO_TROUBLE
        """The same where nobody can tell what it was: a limit that somebody tightened may be lost."""
        self.on_set: Callable[[ParamAnswer], object] = lambda _: None
        """Is told of each parameter that was set, before the service goes by it."""
        self._service, self._instance, self._host = service, instance, host
        self._params, self._log = params, log
        name = f"{PARAMS_FOLDER}/{service}.json"
        self._file = store.path(name)
        self._writer = store.writer(name)
        # A disk that hangs must hold up neither the loop nor who asks for something else meanwhile.
        self._waiting: deque[PendingQuery[ParamSave, ParamAnswer]] = deque(maxlen=_MOST_WAITING)
        self._writing: tuple[PendingQuery[ParamSave, ParamAnswer], dict[str, Any]] | None = None
        self._on_disk: dict[str, Any] | None = None
        """Parameters that the file has; None: unknown, and the next save writes it."""
        self._restore(store, name)

    def turn(
        self, describes: Describes, sets: Sets, saves: Saves, reconfigure: Callable[[ConfigT], None] | None
    ) -> None:
        """Answer what has come. `reconfigure` takes what is in force from now on; None: nothing can be set."""
        if not (describes or sets or saves or self._writing):
            return
        for asked in describes.pop_all():
            asked.answer(self._answer(NO_TROUBLE))
        for to_set in sets.pop_all():
            to_set.answer(self._set(to_set.request, reconfigure))
        self._waiting.extend(saves.pop_all())
        if self._writing is not None and (why := self._writer.outcome()) is not None:
            (asked_to_save, kept), self._writing = self._writing, None
            asked_to_save.answer(self._saved(asked_to_save.request, kept, why))
        while self._writing is None and self._waiting:
            self._begin_to_save(self._waiting.popleft())

    def _set(self, request: ParamSet, reconfigure: Callable[[ConfigT], None] | None) -> ParamAnswer:
        if reconfigure is None:
            only = f"{self._service} takes the robot file and a restart for each of its parameters"
            return self._answer(Trouble(only))
        before = self._params.config
        try:
            self._params.set(request.name, request.value)
        except ParamError as error:
            return self._answer(Trouble(str(error)), mistyped=isinstance(error, MistypedError))
        answer = self._answer(NO_TROUBLE, request.name)
        if self._params.config == before:
            return answer
        self.on_set(answer)
        reconfigure(self._params.config)
        self._log("%s is %s, by %s", request.name, self._params.value(request.name), brief(request.by))
        return answer

    def _begin_to_save(self, asked: PendingQuery[ParamSave, ParamAnswer]) -> None:
        try:
            kept = self._params.to_save(asked.request.names)
        except ParamError as error:
            asked.answer(self._answer(Trouble(str(error)), mistyped=isinstance(error, MistypedError)))
            return
        if kept == self._on_disk:
            asked.answer(self._done(asked.request, kept))
            return
        self._writing, self._on_disk = (asked, kept), None
        self._writer.save(msgspec.json.format(msgspec.json.encode(kept)) + b"\n")

    def _saved(self, request: ParamSave, kept: dict[str, Any], why_not: str) -> ParamAnswer:
        if why_not:
            return self._answer(Trouble(f"{why_not}; the value counts until a restart", _MAKE_WRITABLE))
        self._params.saved = self._on_disk = kept
        self._log("saved in %s, by %s: %s", self._file, brief(request.by), kept)
        return self._done(request, kept)

    def _done(self, request: ParamSave, kept: dict[str, Any]) -> ParamAnswer:
        return self._answer(NO_TROUBLE, *(request.names or (*kept, *self._params.unsaved)))

    def _restore(self, store: Store, name: str) -> None:
        restart = f"restart giraff_{self._service}"
        try:
            saved = msgspec.json.decode(store.read(name), type=dict[str, Any])
            require_sendable(saved)
        except FileNotFoundError:
            return
        except OSError as error:
            unread = f"what was saved does not count: {self._file}: {error.strerror}"
            self.fault = self.lost = Trouble(unread, f"mend or remove the file, and {restart}")
            return
        except (ValueError, RecursionError) as error:
            damaged = f"what was saved does not count: {self._file} is damaged ({plain(error)})"
            self.fault = self.lost = Trouble(damaged, f"set and save again, or remove the file, and {restart}")
            return
        ignored = self._params.restore(saved)
        if self._params.saved:
            self._log("as saved in %s, not as in the robot file: %s", self._file, self._params.saved)
        if unknown := self._params.unknown:
            told = ", ".join(f"{each} = {saved[each]}" for each in unknown)
            what = f"no parameter has the name of a value that is saved in {self._file}: {told}"
            remedy = f"set the value under its present name and save it, or remove the file, and {restart}"
            self.fault = self.lost = Trouble(what[:_LONGEST], remedy)
        elif ignored:
            self.fault = Trouble(
                f"{self._file}: {'; '.join(ignored)}", f"save again, or remove the file, and {restart}"
            )
        else:
            self._on_disk = self._params.saved

    def _answer(self, refusal: Trouble, *names: str, mistyped: bool = False) -> ParamAnswer:
        return ParamAnswer(
            service=self._service,
            instance=self._instance,
            host=self._host,
            done=not refusal,
            reason=refusal,
            mistyped=mistyped,
            params=() if refusal else self._params.describe(names),
        )
