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
from station.panel.pages.replay.judging import judge_images
from station.records import Part
from station.replay.files import sources
from station.replay.results import as_entry
from station.settings.file import load
from station.settings.model import ArchiveSettings, Settings, for_images, for_recipe, for_scale
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


def at_scale(frame: Image, um_per_px: float) -> Image:
    """A shipped frame as a camera of another scale sees it."""
    factor = 13.0 / um_per_px
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(frame, None, fx=factor, fy=factor, interpolation=method), np.uint8)


def replayed(folder: Path, out: Path, *options: str) -> dict[str, dict[str, object]]:
    """Results of a replay without the time it took."""
    assert main(["replay", str(folder), "--json", str(out), "--processes", "1", *options]) == 0
    return {name: {**e, "inspection_ms": None} for name, e in json.loads(out.read_text()).items()}


@pytest.fixture(scope="module")
def of_ours(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, object]]:
    """Results of the shipped frames at the networks' scale."""
    return replayed(FRAMES, tmp_path_factory.mktemp("ours") / "out.json")


@pytest.mark.parametrize("um_per_px", [9.0, 20.0, 26.0, 39.0, 65.0])
def test_the_scale_of_the_settings_and_that_of_the_option_give_the_same_right_verdicts(
    um_per_px: float, tmp_path: Path, frames: dict[str, Image], of_ours: dict[str, dict[str, object]]
) -> None:
    for item in labels():
        cv2.imwrite(str(tmp_path / item["frame"]), at_scale(frames[item["frame"]], um_per_px))
    settings = tmp_path / "station.toml"
    settings.write_text(
        f'[camera]\nkind = "replay"\nfolder = "."\n[weld]\num_per_px = {um_per_px}\n'
        f'[model]\npath = "{MODEL}"\nring_path = "{SHIPPED / "ring.onnx"}"\n'
        f'seen_path = "{SHIPPED / "seen.onnx"}"\n'
    )
    found = replayed(tmp_path, tmp_path / "a.json", "--um-per-px", str(um_per_px))
    assert found == replayed(tmp_path, tmp_path / "b.json", "-c", str(settings))
    inspector = load_inspector(load(settings))[0]
    done = judge_images(
        for_images(SHIPPED), tmp_path, None, um_per_px=um_per_px, progress=lambda _done, _of: True
    )
    assert done is not None
    for item in labels():
        entry, ours = found[item["frame"]], of_ours[item["frame"]]
        assert (entry["verdict"], entry["reason"]) == (item["verdict"], ours["reason"])
        factor = 13.0 / um_per_px
        assert entry["center"] == pytest.approx([(c + 0.5) * factor - 0.5 for c in item["center"]], abs=4)
        assert entry["radius"] == pytest.approx(item["radius"] * factor, rel=0.02)
        judged = inspector.inspect(at_scale(frames[item["frame"]], um_per_px))
        assert entry["segments"] == list(judged.nok_scores), "the line judges alike"
        assert as_entry(done.results[item["frame"]])["segments"] == entry["segments"], "and the window"
        if um_per_px <= 39:
            lengths = [[f["length_mm"] for f in e["findings"]] for e in (entry, ours)]  # type: ignore[attr-defined]
            assert lengths[0] == pytest.approx(lengths[1], rel=0.15), "mm of the part"


def test_a_record_is_judged_and_exported_at_the_scale_at_which_it_was_taken(
    tmp_path: Path, frames: dict[str, Image], capsys: pytest.CaptureFixture[str]
) -> None:
    crops = {}
    for um_per_px in (13.0, 26.0):
        folder, target = tmp_path / f"records-{um_per_px:g}", tmp_path / f"crops-{um_per_px:g}"
        images = {name: at_scale(frame, um_per_px) for name, frame in frames.items()}
        record_all(folder, for_scale(for_images(SHIPPED), um_per_px), images)
        again = ["replay", str(folder), "--processes", "1", "--um-per-px", str(um_per_px)]
        assert main([*again, "--report", str(tmp_path / "report")]) == 0
        assert "4, of which 4 agree bit for bit" in capsys.readouterr().out
        assert "cannot be read" not in (tmp_path / "report" / "report.html").read_text()
        assert main(["records", "export", str(folder), str(target), "--format", "dataset"]) == 0
        crops[um_per_px] = {path.relative_to(target): read_marked(path)[0] for path in target.rglob("*.png")}
    assert main(["replay", str(tmp_path / "records-26"), "--processes", "1"]) == 1, "its scale is forgotten"
    output = capsys.readouterr()
    assert output.err.count("taken at 26 µm/px, but judged as 13 µm/px") == 4
    assert "compared with the line: 0 parts" in output.out
    assert crops[26.0].keys() == crops[13.0].keys()
    for name, crop in crops[13.0].items():
        away = np.abs(crop.astype(float) - crops[26.0][name])
        assert away.mean() < 0.35 * np.abs(crop.astype(float) - crop.mean()).mean() + 2, name


@pytest.mark.parametrize("um_per_px", ["8.9", "66"])
def test_a_scale_that_was_not_trained_is_refused(
    um_per_px: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "part.png").write_bytes((FRAMES / label_with("OK")["frame"]).read_bytes())
    assert main(["replay", str(tmp_path), "--um-per-px", um_per_px]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "scale of the images: the networks are trained for 9 to 65 µm/px" in line
    assert "use another lens, or train networks" in line


def test_an_image_too_small_for_the_weld_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cv2.imwrite(str(tmp_path / "small.png"), np.full((1008, 1200), 90, np.uint8))
    assert main(["replay", str(tmp_path), "--processes", "1"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert "small.png: images of 1200 x 1008 px are too small for a radius of 5.564 + 0.156 mm" in line


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
    networks = (
        f'path = "{MODEL}"\nring_path = "{SHIPPED / "ring.onnx"}"\nseen_path = "{SHIPPED / "seen.onnx"}"\n'
    )
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
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    inspect = Inspector.inspect

    def with_a_fault(inspector: Inspector, image: Image) -> Inspection:
        if image.shape == (1, 1):
            raise RuntimeError("a fault")
        return inspect(inspector, image)

    monkeypatch.setattr(Inspector, "inspect", with_a_fault)
    cv2.imwrite(str(tmp_path / "dot.png"), np.zeros((1, 1), np.uint8))
    (tmp_path / "part.png").write_bytes((FRAMES / label_with("OK")["frame"]).read_bytes())
    assert main(["replay", str(tmp_path), "--processes", "1"]) == 1
    output = capsys.readouterr()
    assert "dot.png: could not be judged (RuntimeError: a fault)" in output.err
    assert output.out.startswith("2 images: 1 OK")
