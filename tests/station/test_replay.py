"""Recorded images judged again: any files, any scale, on all cores, resumed, compared with the line."""

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import cv2
import numpy as np
import pytest

import station.replay.run
from station.__main__ import main
from station.archive.writer import Archive
from station.domain import Frame, Image, Inspection, Origin
from station.errors import ImageError
from station.files.image import read_marked
from station.inspection.inspector import Inspector
from station.inspection.loading import load_inspector
from station.records import Part
from station.replay.files import sources
from station.settings.file import load
from station.settings.model import ArchiveSettings, Settings, for_images, for_recipe
from tests.conftest import MODEL
from tests.parts import FRAMES, label_with, labels

SHIPPED = MODEL.parent


def test_a_folder_of_all_sorts_is_judged_as_far_as_it_can_be(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good = (FRAMES / label_with("OK")["frame"]).read_bytes()
    folder = tmp_path / "Prüfling 7 äöü"
    folder.mkdir()
    (folder / "good part.png").write_bytes(good)
    (folder / "notes.txt").write_text("not a picture")
    (folder / "empty.png").write_bytes(b"")
    (folder / "truncated.png").write_bytes(good[: len(good) // 3])
    (folder / "text.png").write_text("not a picture either")
    with (folder / "huge.tiff").open("wb") as file:
        file.truncate(2 << 30)
    (folder / "again.png").symlink_to(folder / "good part.png")
    (folder / "loop").symlink_to(folder)
    (folder / "self.png").symlink_to(folder / "self.png")
    assert main(["replay", str(folder), "--json", str(tmp_path / "out.json"), "--processes", "1"]) == 1
    output = capsys.readouterr()
    entries = json.loads((tmp_path / "out.json").read_text())
    assert sorted(entries) == ["again.png", "empty.png", "huge.tiff", "self.png", "text.png", "truncated.png"]
    assert entries["again.png"]["verdict"] == "OK", "of two names for one file the first"
    for name in ("empty.png", "huge.tiff", "self.png", "text.png"):
        assert entries[name]["verdict"] == "ERROR"
        assert name in output.err
    assert "larger than 512 MiB" in output.err
    assert entries["truncated.png"]["verdict"] in ("ERROR", "NOK"), "half a picture is never OK"


def test_links_in_a_circle_end(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "b").symlink_to(tmp_path)
    cv2.imwrite(str(tmp_path / "a" / "x.png"), np.zeros((9, 9), np.uint8))
    assert [s.name for s in sources([tmp_path])] == ["x.png"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(ImageError, match="no images found"):
        sources([tmp_path / "empty"])


@pytest.mark.parametrize(
    ("name", "make", "warning"),
    [
        ("a.png", lambda grey: grey, None),
        ("a.bmp", lambda grey: grey, None),
        ("a.tiff", lambda grey: grey.astype(np.uint16) * 256 + 77, None),
        ("a.jpg", lambda grey: grey, "JPEG"),
        ("a.png", lambda grey: np.dstack([grey] * 3), None),
        ("a.png", lambda grey: np.dstack([grey, grey, 255 - grey]), "colour"),
    ],
)
def test_images_from_elsewhere_are_read_with_a_word_of_what_was_lost(
    name: str, make: object, warning: str | None, tmp_path: Path
) -> None:
    grey = np.asarray(np.random.default_rng(0).integers(0, 256, (40, 60)), np.uint8)
    cv2.imwrite(str(tmp_path / name), make(grey))  # type: ignore[operator]
    image, warnings = read_marked(tmp_path / name)
    assert [w.split(":")[0] for w in warnings] == ([] if warning is None else [warning])
    if warning is None:
        assert (image == grey).all()


@pytest.mark.parametrize("um_per_px", [20.0, 10.0])
def test_pictures_of_another_scale_are_brought_to_ours(
    um_per_px: float, tmp_path: Path, frames: dict[str, Image]
) -> None:
    for item in labels():
        frame = frames[item["frame"]]
        factor = 13.0 / um_per_px
        other = cv2.resize(
            frame, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC
        )
        cv2.imwrite(str(tmp_path / item["frame"]), other)
    assert (
        main(
            [
                "replay",
                str(tmp_path),
                "--um-per-px",
                str(um_per_px),
                "--json",
                str(tmp_path / "out.json"),
                "--processes",
                "1",
            ]
        )
        == 0
    )
    entries = json.loads((tmp_path / "out.json").read_text())
    for item in labels():
        found = entries[item["frame"]]
        assert found["verdict"] == item["verdict"]
        assert found["center"] == pytest.approx([(c + 0.5) * factor - 0.5 for c in item["center"]], abs=4)
        assert found["radius"] == pytest.approx(item["radius"] * factor, rel=0.02)


@pytest.mark.parametrize(
    "option", [["--um-per-px", "0"], ["--processes", "0"], ["--recipe", "9"], ["--model", "/absent.onnx"]]
)
def test_wrong_options_are_one_line(option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(FRAMES), *option]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = ["replay", str(FRAMES), "--json", str(tmp_path / "out.json"), "--processes", "1"]
    judge, judged = station.replay.run.judge_image, []

    def until_the_third(*arguments: object) -> object:
        judged.append(arguments[1])
        if len(judged) == 3:
            raise KeyboardInterrupt
        return judge(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(station.replay.run, "judge_image", until_the_third)
    assert main(command) == 130
    part = tmp_path / "out.json.part"
    assert not (tmp_path / "out.json").exists()
    with part.open("a") as file:
        file.write('["cut off in the mid')
    assert main(command) == 0
    assert len(judged) == 3 + 2, "two of four were known"
    entries = json.loads((tmp_path / "out.json").read_text())
    assert [entries[item["frame"]]["verdict"] for item in labels()] == [item["verdict"] for item in labels()]
    assert not part.exists()


def test_all_cores_say_the_same_as_one(tmp_path: Path) -> None:
    for number in range(2):
        for item in labels():
            (tmp_path / f"{number}-{item['frame']}").write_bytes((FRAMES / item["frame"]).read_bytes())
    results = []
    for processes in ("1", "2"):
        out = tmp_path.parent / f"{tmp_path.name}-{processes}.json"
        assert main(["replay", str(tmp_path), "--json", str(out), "--processes", processes]) == 0
        results.append({name: {**e, "inspection_ms": 0} for name, e in json.loads(out.read_text()).items()})
    assert results[0] == results[1]
    assert len(results[0]) == 8


def record_all(folder: Path, settings: Settings, frames: dict[str, Image]) -> Path:
    """Four parts as a line with these settings judges them."""
    inspector, provenance = load_inspector(settings)
    kept = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    for number, item in enumerate(labels(), start=1):
        frame = Frame(
            frames[item["frame"]], datetime(2026, 11, 22, 12, number, tzinfo=UTC), "cam", Origin.SIMULATED
        )
        part = Part(item["frame"], number, Origin.SIMULATED)
        kept.commit(kept.begin(frame), inspector.inspect(frame.image), part, provenance, now=frame.grabbed_at)
    kept.close()
    return folder


@pytest.fixture
def archive(tmp_path: Path, frames: dict[str, Image]) -> Path:
    return record_all(tmp_path / "records", for_images(SHIPPED), frames)


def test_an_archive_is_judged_as_on_the_line_to_the_bit(
    archive: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(archive), "--processes", "1"]) == 0
    output = capsys.readouterr().out
    assert "4 parts, 0 verdicts flip" in output
    assert "4, of which 4 agree bit for bit" in output


def test_a_candidate_is_compared_with_the_line(
    archive: Path, tmp_path: Path, frames: dict[str, Image], capsys: pytest.CaptureFixture[str]
) -> None:
    networks = f'path = "{MODEL}"\nring_path = "{SHIPPED / "ring.onnx"}"\n'
    path = tmp_path / "station.toml"
    path.write_text(
        f'[camera]\nkind = "replay"\nfolder = "."\n[model]\n{networks}'
        "[recipes.2]\nmodel = { hole_threshold = 0.0001 }\n"
    )
    ok = sum(item["verdict"] == "OK" for item in labels())
    assert main(["replay", str(archive), "-c", str(path), "--recipe", "2", "--processes", "1"]) == 0
    strict = capsys.readouterr().out
    assert f"OK to NOK: {ok}" in strict
    assert "NOK to OK: 0, would be released" in strict
    assert "agree bit for bit" not in strict
    record_all(tmp_path / "strict", for_recipe(load(path), 2), frames)
    assert main(["replay", str(tmp_path / "strict"), "--processes", "1"]) == 0
    assert f"NOK to OK: {ok}, would be released" in capsys.readouterr().out


def test_a_record_that_the_same_judge_judges_otherwise_is_a_fault(
    tmp_path: Path,
    frames: dict[str, Image],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    inspect = Inspector.inspect

    def by_a_failing_machine(inspector: Inspector, image: Image) -> Inspection:
        judged = inspect(inspector, image)
        return replace(
            judged, scores=(replace(judged.scores[0], ok=judged.scores[0].ok - 1e-9), *judged.scores[1:])
        )

    monkeypatch.setattr(Inspector, "inspect", by_a_failing_machine)
    archive = record_all(tmp_path / "records", for_images(SHIPPED), frames)
    monkeypatch.undo()
    next(archive.rglob("00000002.png")).write_bytes((FRAMES / labels()[0]["frame"]).read_bytes())
    assert main(["replay", str(archive), "--processes", "1"]) == 1
    output = capsys.readouterr()
    assert output.err.count("not reproducible") == 3
    assert "00000002.json: its frame 2026-11-22/00000002.png was modified" in output.err
    assert "compared with the line: 3 parts" in output.out


def test_one_image_that_cannot_be_judged_does_not_end_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cv2.imwrite(str(tmp_path / "dot.png"), np.zeros((1, 1), np.uint8))
    (tmp_path / "part.png").write_bytes((FRAMES / label_with("OK")["frame"]).read_bytes())
    assert main(["replay", str(tmp_path), "--um-per-px", "5", "--processes", "1"]) == 1
    output = capsys.readouterr()
    assert "dot.png: could not be judged" in output.err
    assert output.out.startswith("2 images")
