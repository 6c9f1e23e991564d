"""Access rights: the level that each request needs."""

from collections.abc import Mapping

from station.channel.requests import (
    Acknowledge,
    ChangeSettings,
    CheckMaster,
    EndService,
    GiveReview,
    HoldService,
    LogIn,
    LogOut,
    ReloadSettings,
    RemoveUser,
    Request,
    ResetCounts,
    SaveUser,
    StayLoggedIn,
    TakeTestImage,
)
from station.errors import LoginError, SettingsError
from station.journal.users import Level, User

NEEDED: Mapping[type[Request], Level | None] = {
    LogIn: None,
    StayLoggedIn: Level.OPERATOR,
    LogOut: Level.OPERATOR,
    Acknowledge: Level.OPERATOR,
    GiveReview: Level.OPERATOR,
    TakeTestImage: Level.OPERATOR,
    CheckMaster: Level.SETTER,
    HoldService: Level.SETTER,
    EndService: Level.SETTER,
    ResetCounts: Level.SETTER,
    ChangeSettings: Level.SETTER,
    ReloadSettings: Level.QUALITY,
    SaveUser: Level.ADMIN,
    RemoveUser: Level.ADMIN,
}
"""Minimum level for each kind of request; None: no login.

A second review, of a part that another user has reviewed, needs QUALITY; `save_review` checks that.
"""
CHANGES: Mapping[str, Level] = {"camera": Level.SETTER, "recipes": Level.QUALITY}
"""Minimum level for a change of these settings; others cannot be changed by request."""


def needed(request: Request) -> Level | None:
    """Return the level that a request needs; None: no login. Raises SettingsError if it is never allowed."""
    level = NEEDED[type(request)]
    if level is None or not isinstance(request, ChangeSettings):
        return level
    for value in request.values:
        if value.place[0] not in CHANGES:
            name = ".".join(value.place)
            raise SettingsError(f"{name}: cannot be changed at the station. Edit the settings file.")
        level = max(level, CHANGES[value.place[0]])
    return level


def check(request: Request, user: User | None) -> None:
    """Raise LoginError if `user` (None: no login) may not request this, SettingsError if no user may."""
    level = needed(request)
    if level is not None and (user is None or user.level < level):
        raise LoginError(f"a login of the level {level.name.lower()} is needed")
