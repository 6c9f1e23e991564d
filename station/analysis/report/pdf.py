"""Writes a report as PDF; the only file that imports WeasyPrint."""

from pathlib import Path

from station.errors import RecordError
from station.files.durable import replacing


def write_pdf(page: str, target: Path) -> None:
    """Write an HTML page as PDF.

    Raises RecordError if WeasyPrint or its system library Pango is not installed, OSError if it cannot be
    written.
    """
    try:
        from weasyprint import HTML
    except ImportError:
        raise RecordError(
            "PDF needs the package weasyprint; install it with pip install 'weldgate[pdf]', "
            "or print the HTML page in a browser"
        ) from None
    except OSError as error:
        reason = str(error).splitlines()[0]
        raise RecordError(
            f"PDF needs the system library Pango ({reason}); install libpango-1.0-0, "
            "or print the HTML page in a browser"
        ) from None
    with replacing(target) as part:
        HTML(string=page).write_pdf(part)
