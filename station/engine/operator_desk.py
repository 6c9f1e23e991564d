"""Carries out the requests of windows, within the rights of their logins.

It owns accounts, reviews, acknowledgements and service mode, and gives orders to the cycle. Each request gets
one answer. Every action is in the journal before it is done.
"""

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
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
from station.journal.accounts import Accounts
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.journal.review_writer import save_review
from station.journal.users import Level, User
from station.plc.map.registers import Status
from station.plc.port import Counts

log = logging.getLogger("weldgate.requests")

FRESH_S = 2.0
"""Age from which a request is refused: its sender has already seen that there was no answer."""
ACKNOWLEDGEABLE = 2000
"""Number of newest alarm entries that can be acknowledged."""
OTHER_IN_SERVICE = "another user is in service mode"
"""Refusal of service mode."""

Reply = Callable[[Answer], None]
"""Function that sends an answer."""
Start = Callable[[str, Message, Reply], None]
"""Function that starts long work: name of the user, request, and how to reply."""


@dataclass(frozen=True, slots=True)
class _Lease:
    """Service mode held by one login; `until_s` is monotonic."""

    token: str
    who: str
    bit: int = field(kw_only=True)
    setup_images: bool = field(kw_only=True)
    until_s: float = field(kw_only=True)


class OperatorDesk:
    """Answers requests by the rights of the logins. Use from one thread."""

    def __init__(
        self,
        folder: Path,
        logins: Logins,
        accounts: Accounts,
        *,
        hand_over: Callable[[orders.Order], None],
        counts: Callable[[], Counts | None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`folder`: the archive; `hand_over` gives an order to the cycle; `counts` returns the counters."""
        self._folder, self._logins, self._accounts = folder, logins, accounts
        self._hand_over, self._counts, self._clock = hand_over, counts, clock
        self._lease: _Lease | None = None

    def handle(self, message: Message, reply: Reply, change: Start, *, source: str = "") -> None:
        """Answer a request by `reply`; changes of settings are started by `change`, which replies later.

        `source`: account and process of this machine that sent it.
        """
        now_s = self._clock()
        user = self._logins.user(message.token, now_s)
        self._logins.renew(message.token, False, now_s)
        try:
            if abs(now_s - message.sent_s) > FRESH_S:
                raise WeldgateError(TOO_OLD)
            check(message.request, user)
            if isinstance(message.request, LogIn):
                reply(self._log_in(message, message.request, source))
            elif user is None:
                raise LoginError(FAULT)
            elif isinstance(message.request, ChangeSettings | ReloadSettings):
                change(user.name, message, reply)
            else:
                self._carry_out(message.request, user, message.token)
                reply(Answer(message.request_id, logged_in=True))
        except WeldgateError as error:
            locked_s = error.locked_s if isinstance(error, LoginError) else 0.0
            logged_in = user is not None
            reply(Answer(message.request_id, str(error), logged_in=logged_in, locked_s=locked_s))
        except Exception:  # a request that fails must not affect other windows
            log.exception("request %r failed", message.request)
            reply(Answer(message.request_id, FAULT, logged_in=user is not None))

    def _log_in(self, message: Message, request: LogIn, source: str) -> Answer:
        name = request.name.strip()
        if request.code:
            user = self._accounts.commission(name, request.pin, request.code, source=source)
        else:
            user = self._accounts.log_in(name, request.pin, source=source)
        self._log_out(message.token, "another user logged in")
        token = self._logins.begin(user, self._clock())
        return Answer(message.request_id, logged_in=True, token=token, name=user.name, level=user.level)

    def _log_out(self, token: str, why: str) -> None:
        """End a login and its service mode, even if the journal cannot be written."""
        if self._lease is not None and self._lease.token == token:
            self._end_service(why)
        if (user := self._logins.end(token)) is not None:
            with suppress(RecordError):
                self._accounts.log_out(user, why)

    def _carry_out(self, request: Request, user: User, token: str) -> None:
        """Carry out a request that the user may make. Raises WeldgateError if it was not carried out."""
        match request:
            case StayLoggedIn():
                self._logins.renew(token, request.touched, self._clock())
            case LogOut():
                self._log_out(token, request.why)
            case SaveUser():
                self._accounts.save_user(request.name, level=request.level, pin=request.pin, by=user.name)
                self._end_logins_of(request.name.strip())
            case RemoveUser():
                self._accounts.remove_user(request.name, by=user.name)
                self._end_logins_of(request.name)
            case Acknowledge():
                self._acknowledge(request, user)
            case GiveReview():
                self._review(request, user)
            case TakeTestImage():
                self._note(user, "test image")
                self._hand_over(orders.TestImage())
            case CheckMaster():
                self._note(user, "test image", after=request.serial)
                self._hand_over(orders.TestImage(request.serial))
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
        append(self._folder, Kind.SERVICE, user.name, subject, before=before, after=after)

    def _end_logins_of(self, name: str) -> None:
        """End the logins of a user whose level or PIN has changed."""
        for token in self._logins.tokens(name):
            self._log_out(token, "user changed")

    def _acknowledge(self, request: Acknowledge, user: User) -> None:
        alarms = entries(self._folder, (Kind.ALARM,), limit=ACKNOWLEDGEABLE)
        if all(entry.number != request.number for entry in alarms):
            raise RecordError("there is no such alarm")
        append(self._folder, Kind.ALARM_SEEN, user.name, str(request.number))

    def _review(self, request: GiveReview, user: User) -> None:
        rows = find(self._folder, Query(number=request.inspection_id))
        if not rows:
            raise RecordError(f"part {request.inspection_id} does not exist in the archive")
        try:
            save_review(
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
            raise LoginError(OTHER_IN_SERVICE)
        if request.bit and request.bit not in [int(flag) for flag in Status]:
            raise LoginError(f"{request.bit} is not a single bit of STATUS")
        if held is None:
            self._note(user, "service mode", after="begins")
        bit, images = (0, False) if held is None else (held.bit, held.setup_images)
        if request.bit != bit:
            self._note(user, "bit by hand", _bit_name(bit), _bit_name(request.bit))
        if request.look != images:
            self._note(user, "setup images", after="begins" if request.look else "over")
        self._lease = _Lease(
            token, user.name, bit=request.bit, setup_images=request.look, until_s=now_s + LEASE_S
        )
        order = orders.Service(
            user.name,
            bit=request.bit,
            setup_images=request.look,
            exposure_us=request.exposure_us,
            gain_db=request.gain_db,
        )
        self._hand_over(order)

    def _end_service(self, why: str) -> None:
        if (lease := self._lease) is None:
            return
        self._lease = None
        self._hand_over(orders.Service(lease.who, ended=True))
        with suppress(RecordError):  # service mode must end even if the journal cannot be written
            entry = {"before": "begins", "after": "over", "reason": why}
            append(self._folder, Kind.SERVICE, lease.who, "service mode", **entry)

    def tick(self) -> None:
        """End service mode and logins that were not renewed in time."""
        now_s = self._clock()
        if self._lease is not None and now_s > self._lease.until_s:
            self._end_service("window closed")
        for token, why in self._logins.ended(now_s):
            self._log_out(token, why)

    def close(self) -> None:
        """End all logins, because the engine stops."""
        for token in self._logins.tokens():
            self._log_out(token, "engine stopped")


def _bit_name(bit: int) -> str:
    return str(Status(bit).name) if bit else "–"
