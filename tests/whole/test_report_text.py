"""Text in the three reports: the content of serials, file names and titles never becomes markup."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import models.evaluation.report
import station.analysis.report.page
import station.replay.report
from models.evaluation.evaluate import Evaluation, PartResult, evaluate_lot
from station.__main__ import main
from station.analysis.report.template import UNSEEN, render
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import Frame, Image, Inspection, Origin
from station.inspection.inspector import Inspector
from station.inspection.networks import load_networks
from station.records import Part
from station.settings.model import ArchiveSettings, ModelSettings, QualitySettings, WeldSettings
from tests.conftest import NETWORKS, ROOT
from tests.parts import FRAMES, label_with, nok_inspection, ok_inspection, provenance
from tests.station.test_report import NOON

HOSTILE = '<script>alert(\'1\')</script>" onload="x" \x00\x1b[2J\n\u202e&lt;{{ page }}'
SHOWN = '<script>alert(\'1\')</script>" onload="x" \\x00\\x1b[2J\\n\\u202e&lt;{{ page }}'
FILE = "\"><img src=x onerror='alert(1)'>\x1b\udcff&amp;.png"
FILE_SHOWN = "\"><img src=x onerror='alert(1)'>\\x1b\\udcff&amp;.png"
ELEMENTS = {
    "html",
    "head",
    "meta",
    "title",
    "style",
    "body",
    "h1",
    "h2",
    "h3",
    "p",
    "b",
    "ul",
    "li",
    "table",
    "tr",
    "th",
    "td",
}
ELEMENTS |= {"div", "figure", "figcaption", "img", "svg", "path", "rect", "text", "line", "circle"}


class Seen(HTMLParser):
    """What a browser makes of a page: elements with the names of their attributes, and all text."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, ...]] = []
        self.text = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, *(name for name, _ in attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_comment(self, data: str) -> None:
        self.elements.append(("comment",))


Pages = dict[Path, tuple[Any, str]]
"""By template: what it was given, and the file that was written."""


@pytest.fixture(scope="module")
def evaluation(tmp_path_factory: pytest.TempPathFactory) -> Evaluation:
    """The shipped frames, evaluated, and a part of a hostile name that was not judged."""
    lot = tmp_path_factory.mktemp("lot")
    (lot / "frames").symlink_to(FRAMES)
    (lot / "labels.json").symlink_to(FRAMES / "labels.json")
    inspector = Inspector(
        load_networks(NETWORKS),
        weld=WeldSettings(),
        quality=QualitySettings(),
        model=ModelSettings(),
    )
    found = evaluate_lot(lot, inspector)
    error = PartResult(
        name=HOSTILE,
        truth="NOK",
        verdict="ERROR",
        reason=HOSTILE,
        center_error_px=None,
        radius_error_px=None,
        novelty=None,
        novel=False,
        defects=(),
    )
    return replace(found, parts=(*found.parts, error))


@pytest.fixture(scope="module")
def pages(
    tmp_path_factory: pytest.TempPathFactory, frames: dict[str, Image], evaluation: Evaluation
) -> Pages:
    """The three reports, from real records, images and networks, with hostile names throughout."""
    folder = tmp_path_factory.mktemp("pages")
    given: dict[Path, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        for module in (station.analysis.report.page, station.replay.report, models.evaluation.report):
            patch.setattr(module, "render", _noting(given))
        records = _records(folder / "records", frames[label_with("hole")["frame"]])
        (folder / "truth.json").write_text(json.dumps({HOSTILE + "0": "NOK", HOSTILE + "1": "OK"}))
        ways = [str(folder / "r.html"), "--title", HOSTILE, "--truth", str(folder / "truth.json")]
        assert main(["records", "report", str(records), *ways]) == 1
        (folder / "images").mkdir()
        for item in (label_with("OK"), label_with("hole")):
            shutil.copy(FRAMES / item["frame"], folder / "images" / f"{item['verdict']}{FILE}")
        (folder / "images" / f"broken{FILE}").write_bytes(b"x")
        (folder / "truth.json").write_text(json.dumps({f"OK{FILE}": "NOK", f"NOK{FILE}": "OK"}))
        ways = ["--processes", "1", "--report", str(folder / "replay"), "--truth", str(folder / "truth.json")]
        assert main(["replay", str(folder / "images"), str(records), *ways]) == 1
        models.evaluation.report.write_report(evaluation, folder / "evaluation", HOSTILE, {HOSTILE: HOSTILE})
    files = (folder / "r.html", folder / "replay" / "report.html", folder / "evaluation" / "report.html")
    return {
        template: (page, file.read_text())
        for (template, page), file in zip(given.items(), files, strict=True)
    }


def _noting(given: dict[Path, object]) -> Callable[[Path, object], str]:
    def noting(template: Path, page: object) -> str:
        given[template] = page
        return render(template, page)

    return noting


def _records(folder: Path, image: Image) -> Path:
    """An archive of an OK, a NOK and an ERROR part, of which the last was altered."""
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    judge = replace(provenance(), software=HOSTILE, model_version=HOSTILE, model_hash=HOSTILE)
    for number, inspection in enumerate(
        (ok_inspection(), nok_inspection(), Inspection.error(Reason.NO_WELD_FOUND))
    ):
        part, frame = (
            Part(f"{HOSTILE}{number}", number + 1, Origin.SIMULATED),
            Frame(image, NOON, "cam", Origin.SIMULATED),
        )
        archive.commit(archive.begin(frame), inspection, part, judge, now=NOON)
    archive.close()
    next(folder.rglob("00000003.png")).write_bytes(b"x")
    return folder


def filled(value: Any, text: str) -> Any:
    """The same data with this text in every place that holds text."""
    if isinstance(value, str):
        return text
    if isinstance(value, tuple):
        return tuple(filled(inner, text) for inner in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: filled(getattr(value, f.name), text) for f in fields(value)})
    return value


def test_hostile_names_are_shown_and_nothing_else_comes_of_them(pages: Pages) -> None:
    assert [template.parent.name for template in pages] == ["report", "replay", "evaluation"]
    for template, (_, text) in pages.items():
        seen = Seen(text)
        assert {tag for tag, *_ in seen.elements} <= ELEMENTS
        assert not {"onerror", "onload"} & {name for _, *names in seen.elements for name in names}
        assert UNSEEN.findall(text.replace("\n", "")) == []
        assert (FILE_SHOWN if template.parent.name == "replay" else SHOWN) in seen.text, template
        assert len(seen.text) < 20_000, "no image has become text"


@settings(max_examples=30)
@given(text=st.text(st.characters(), min_size=1))
@example(text=HOSTILE)
@example(text="]]>--><!-- <svg/onload=x> {% raw %} '\"`")
def test_no_text_changes_what_a_page_is_made_of(text: str, pages: Pages) -> None:
    shown = UNSEEN.sub(lambda found: found[0].encode("unicode_escape").decode(), text)
    for template, (page, _) in pages.items():
        harmless, hostile = (render(template, filled(page, words)) for words in ("x", text))
        seen = Seen(hostile)
        assert seen.elements == Seen(harmless).elements, template
        assert seen.text.count(shown) >= 10, template
        assert hostile.encode()


def test_no_template_switches_escaping_off() -> None:
    templates = [path for room in ("station", "models") for path in (ROOT / room).rglob("*.j2")]
    assert len(templates) >= 5
    for path in templates:
        assert not re.search(r"\bsafe\b|autoescape|Markup", path.read_text()), path


IMPORTS = """
import sys
opened = []
sys.addaudithook(lambda event, facts: opened.append(str(facts[0])) if event == "open" else None)
import models.evaluation.report, station.replay.report, station.analysis.report.page
import models.evaluation.report, station.replay.report, station.analysis.report.page
print([name for name in opened if name.endswith((".j2", ".css"))], "jinja2" in sys.modules)
"""


def test_importing_reads_no_template() -> None:
    done = subprocess.run(
        [sys.executable, "-c", IMPORTS], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "[] False\n"
