"""Fills HTML templates; the only file that imports Jinja.

A template is next to the code that fills it. All templates share layout.html.j2, parts.html.j2 and style.css
in this folder.
"""

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Environment

HERE = Path(__file__).resolve().parent
"""Folder of the shared templates."""
UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that are written as escapes: control characters, direction marks and surrogates, which a page
cannot contain or which change how it reads."""


def render(template: Path, page: object) -> str:
    """Return the HTML text of a template in which `page` is the only name; all values are escaped."""
    return _templates(template.parent).get_template(template.name).render(page=page)


@cache
def _templates(folder: Path) -> "Environment":
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # here so that the window starts faster

    return Environment(
        loader=FileSystemLoader([folder, HERE]),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_seen,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def _seen(value: object) -> object:
    """Return text with its unseen characters escaped; the result of a macro (a subclass of str) as it is."""
    if type(value) is not str:
        return value
    return UNSEEN.sub(lambda found: found[0].encode("unicode_escape").decode(), value)
