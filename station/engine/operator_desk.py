"""Carries out what windows ask for, if their login may.

It keeps accounts, reviews, acknowledgements and service mode, and gives orders to the cycle. Each request gets
one answer. Whatever is done is in the journal before it is done.
"""

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from station.archive.reader import Query, find
from station.channel.requests import (
    FAULT,
    TOO_OLD,
    Acknowledge,
    Answer,
    ChangeSettings,
    CheckMaster,
    EndService,
    GiveReview,
    HoldService,
    LogIn,
    LogOut,
    Message,
    ReloadSettings,
    RemoveUser,
    Request,
    ResetCounts,
    SaveUser,
    StayLoggedIn,
    TakeTestImage,
)
from station.engine import orders
from station.engine.logins import Logins
from station.engine.rights import check
from station.engine.service_mode import LEASE_S
from station.errors import LoginError, RecordError, WeldgateError
from station.journal import accounts
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.journal.review_writer import give
from station.journal.users import Level, User, users
from station.plc.map.registers import Status
from station.plc.port import Counts

log = logging.getLogger("weldgate.requests")

FRESH_S = 2.0
"""An older request is refused: its sender has seen that nothing came."""
LOOKED_AT = 2000
"""Entries of alarms, the newest, that can be acknowledged."""
OTHER_SERVES = "somebody else works on the station"

Reply = Callable[[Answer], None]
Later = Callable[[str, Message, Reply], None]
"""Takes work that may last: who asks, for what, and what is called with the answer."""


@dataclass(frozen=True, slots=True)
class _Lease:
    """Service mode as one login holds it; `until_s` is monotonic."""

    token: str
    who: str
    bit: int
    until_s: float


class OperatorDesk:
    """Knows who is logged in and what they may. Use from one thread."""

    def __init__(
        self,
        folder: Path,
        logins: Logins,
        hand_over: Callable[[orders.Order], None],
        counts: Callable[[], Counts | None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`folder`: the archive; `hand_over` gives an order to the cycle; `counts` returns the counted parts."""
        self._folder, self._logins, self._hand_over, self._counts = folder, logins, hand_over, counts
        self._clock = clock
        self._lease: _Lease | None = None

    def handle(self, message: Message, reply: Reply, change: Later) -> None:
        """Answer a request through `reply`; changes of settings go to `change`, which replies later."""
        now_s = self._clock()
        user = self._logins.user(message.token, now_s)
        self._logins.heard(message.token, False, now_s)
        try:
            if abs(now_s - message.sent_s) > FRESH_S:
                raise WeldgateError(TOO_OLD)
            check(message.request, user)
            if isinstance(message.request, LogIn):
                reply(self._log_in(message, message.request))
            elif user is None:
                raise LoginError(FAULT)
            elif isinstance(message.request, ChangeSettings | ReloadSettings):
                change(user.name, message, reply)
            else:
                self._do(message.request, user, message.token)
                reply(Answer(message.request_id, logged_in=True))
        except WeldgateError as error:
            locked_s = error.locked_s if isinstance(error, LoginError) else 0.0
            reply(Answer(message.request_id, str(error), user is not None, locked_s))
        except Exception:  # one request that fails must not end those of others
            log.exception("request %r", message.request)
            reply(Answer(message.request_id, FAULT, user is not None))

    def _log_in(self, message: Message, request: LogIn) -> Answer:
        name = request.name.strip()
        if not users(self._folder):
            accounts.save_user(self._folder, name, name, Level.ADMIN, request.pin)
        user = accounts.log_in(self._folder, name, request.pin)
        self._log_out(message.token, "another one logs in")
        token = self._logins.begin(user, self._clock())
        return Answer(message.request_id, logged_in=True, token=token, name=user.name, level=user.level)

    def _log_out(self, token: str, why: str) -> None:
        """End a login, and service mode with it: who leaves must be able to, whatever the journal says."""
        if self._lease is not None and self._lease.token == token:
            self._end_service(why)
        if (user := self._logins.end(token)) is not None:
            with suppress(RecordError):
                accounts.log_out(self._folder, user, why)

    def _do(self, request: Request, user: User, token: str) -> None:
        """Carry out a request that the user may make. Raises WeldgateError; then it was not carried out."""
        match request:
            case StayLoggedIn():
                self._logins.heard(token, request.touched, self._clock())
            case LogOut():
                self._log_out(token, request.why)
            case SaveUser():
                accounts.save_user(self._folder, user.name, request.name, request.level, request.pin)
                self._changed(request.name.strip())
            case RemoveUser():
                accounts.remove_user(self._folder, user.name, request.name)
                self._changed(request.name)
            case Acknowledge():
                self._acknowledge(request, user)
            case GiveReview():
                self._review(request, user)
            case TakeTestImage():
                self._note(user, "test picture")
                self._hand_over(orders.TestPicture())
            case CheckMaster():
                self._note(user, "test picture", after=request.serial)
                self._hand_over(orders.TestPicture(request.serial))
            case ResetCounts():
                counts = self._counts()
                before = "" if counts is None else f"OK {counts.ok}, NOK {counts.nok}, ERROR {counts.error}"
                self._note(user, "counters", before, "0")
                self._hand_over(orders.ResetCounts(user.name))
            case HoldService():
                self._hold_service(request, user, token)
            case EndService():
                if self._lease is not None and self._lease.who == user.name:
                    self._end_service("")
            case _:
                raise WeldgateError(FAULT)

    def _note(self, user: User, subject: str, before: str = "", after: str = "") -> None:
        append(self._folder, Kind.SERVICE, user.name, subject, before, after)

    def _changed(self, name: str) -> None:
        """End the logins of a user whose level or PIN has changed."""
        for token in self._logins.tokens(name):
            self._log_out(token, "user changed")

    def _acknowledge(self, request: Acknowledge, user: User) -> None:
        alarms = entries(self._folder, (Kind.ALARM,), limit=LOOKED_AT)
        if all(entry.number != request.number for entry in alarms):
            raise RecordError("there is no such alarm")
        append(self._folder, Kind.ALARM_SEEN, user.name, str(request.number))

    def _review(self, request: GiveReview, user: User) -> None:
        rows = find(self._folder, Query(number=request.inspection_id))
        if not rows:
            raise RecordError(f"there is no part {request.inspection_id}")
        try:
            give(
                self._folder,
                user.name,
                may_second=user.level >= Level.QUALITY,
                inspection_id=request.inspection_id,
                verdict=rows[0].verdict,
                opinion=request.opinion,
                comment=request.comment.strip(),
                marks=request.marks,
            )
        except ValueError as error:
            raise RecordError(str(error)) from None

    def _hold_service(self, request: HoldService, user: User, token: str) -> None:
        held, now_s = self._lease, self._clock()
        if held is not None and held.who != user.name:
            raise LoginError(OTHER_SERVES)
        if request.bit and request.bit not in [int(flag) for flag in Status]:
            raise LoginError(f"{request.bit} is not one bit of STATUS")
        if held is None:
            self._note(user, "service mode", after="begins")
        bit = 0 if held is None else held.bit
        if request.bit != bit:
            self._note(user, "bit by hand", _bit(bit), _bit(request.bit))
        self._lease = _Lease(token, user.name, request.bit, now_s + LEASE_S)
        wanted = (request.bit, request.look, request.exposure_us, request.gain_db)
        self._hand_over(orders.Service(user.name, *wanted))

    def _end_service(self, why: str) -> None:
        if (lease := self._lease) is None:
            return
        self._lease = None
        self._hand_over(orders.Service(lease.who, over=True))
        with suppress(RecordError):  # who leaves must be able to
            append(self._folder, Kind.SERVICE, lease.who, "service mode", "begins", "over", why)

    def tick(self) -> None:
        """End what was not renewed in time."""
        now_s = self._clock()
        if self._lease is not None and now_s > self._lease.until_s:
            self._end_service("window closed")
        for token, why in self._logins.over(now_s):
            self._log_out(token, why)

    def close(self) -> None:
        """End all logins: the engine stops."""
        for token in self._logins.tokens():
            self._log_out(token, "the engine stops")


def _bit(bit: int) -> str:
    return str(Status(bit).name) if bit else "–"
