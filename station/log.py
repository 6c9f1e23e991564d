"""Log of a process: each entry is one line, so that no name, serial or path in it can forge another entry."""

import logging
import sys

FORMAT = "%(asctime)s %(levelname)s %(message)s"
"""Form of an entry."""
CONTINUED = "    | "
"""Prefix of each line of a traceback, which belongs to the entry above."""


def visible(text: str) -> str:
    """Return a text in which line breaks and other control characters are written as escapes."""
    return text if text.isprintable() else "".join(map(_visible, text))


def _visible(character: str) -> str:
    return character if character.isprintable() else character.encode("unicode_escape").decode("ascii")


class OneLine(logging.Formatter):
    """Formats entries without line breaks; the lines of a traceback have a prefix."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  (name of the library)
        """Return the entry with its control characters escaped."""
        return visible(super().formatMessage(record))

    def formatException(self, ei: "logging._SysExcInfoType") -> str:  # noqa: N802
        """Return the traceback with a prefix on each line."""
        return _continued(super().formatException(ei))

    def formatStack(self, stack_info: str) -> str:  # noqa: N802
        """Return the stack with a prefix on each line."""
        return _continued(super().formatStack(stack_info))


def _continued(text: str) -> str:
    return "\n".join(CONTINUED + visible(line) for line in text.splitlines())


def start_log() -> None:
    """Write entries from INFO on to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(OneLine(FORMAT))
    logging.basicConfig(level=logging.INFO, handlers=[handler])
