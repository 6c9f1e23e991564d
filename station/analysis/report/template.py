"""HTML from templates, through Jinja; the only file that imports it.

A template lies next to the code that fills it. All share layout.html.j2, parts.html.j2 and style.css in here.
"""

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Environment

HERE = Path(__file__).resolve().parent
UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that a page cannot hold or that change how it reads: controls, direction marks, surrogates."""


def render(template: Path, page: object) -> str:
    """Fill a template, in which `page` is the only name. All that is filled in is escaped."""
    return _templates(template.parent).get_template(template.name).render(page=page)


@cache
def _templates(folder: Path) -> "Environment":
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # the window starts without it

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
    """Text with its control characters written out; what a macro made, which is a subclass of str, stays."""
    if type(value) is not str:
        return value
    return UNSEEN.sub(lambda found: found[0].encode("unicode_escape").decode(), value)
