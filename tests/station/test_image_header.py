"""Images whose content would be dropped, turned or read otherwise are refused, before they are decoded."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.errors import ImageError
from station.files.image import read_marked
from station.files.image_header import read_header
from station.replay.files import sources
from tests.parts import FRAMES, label_with

GREY = np.arange(64, dtype=np.uint8).reshape(8, 8)
Tags = dict[int, tuple[int, int]]


def tiff(*, tags: Tags | None = None, pages: int = 1, order: str = "<") -> bytes:
    """Return an uncompressed TIFF of 8 x 8 grey pixels; `tags`: type and value by number."""
    data = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, 8)
    for page in range(pages):
        own = {256: (3, 8), 257: (3, 8), 258: (3, 8), 259: (3, 1), 262: (3, 1), 277: (3, 1), 278: (3, 8)}
        own |= {279: (4, 64)} | (tags or {})
        end = len(data) + 2 + (len(own) + 1) * 12 + 4
        own[273] = (4, end)
        entries = b"".join(
            struct.pack(order + "HHI", tag, kind, 1)
            + (struct.pack(order + "HH", value, 0) if kind == 3 else struct.pack(order + "I", value))
            for tag, (kind, value) in sorted(own.items())
        )
        following = end + 64 if page + 1 < pages else 0
        data += struct.pack(order + "H", len(own)) + entries + struct.pack(order + "I", following)
        data += GREY.tobytes()
    return data


def refusal(path: Path, data: bytes) -> str:
    path.write_bytes(data)
    with pytest.raises(ImageError) as caught:
        read_marked(path)
    return str(caught.value)


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_plain_tiff_is_read(tmp_path: Path, order: str) -> None:
    (tmp_path / "a.tif").write_bytes(tiff(order=order))
    image, warnings = read_marked(tmp_path / "a.tif")
    assert (image == GREY).all()
    assert warnings == ()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    ("tags", "said"),
    [
        ({262: (3, 0)}, "white is 0"),
        ({262: (3, 3)}, "palette"),
        ({262: (3, 6)}, "PhotometricInterpretation"),
        ({274: (3, 3)}, "orientation is 3"),
        ({266: (3, 2)}, "order of its bits"),
        ({339: (3, 2)}, "sample format"),
        ({258: (3, 12)}, "12 bits per value"),
        ({256: (3, 40000)}, "too large"),
        ({256: (4, 31999), 257: (4, 31999), 277: (3, 4)}, "MiB decoded"),
    ],
)
def test_what_would_be_seen_otherwise_is_named(tmp_path: Path, order: str, tags: Tags, said: str) -> None:
    assert said in refusal(tmp_path / "a.tif", tiff(tags=tags, order=order))


def test_several_pictures_in_one_file_are_refused(tmp_path: Path) -> None:
    assert "holds 2 pictures" in refusal(tmp_path / "a.tif", tiff(pages=2))
    good = bytearray(cv2.imencode(".png", GREY)[1].tobytes())
    chunk = b"acTL" + struct.pack(">II", 3, 0)
    good[33:33] = struct.pack(">I", 8) + chunk + struct.pack(">I", zlib.crc32(chunk))
    assert "holds 3 pictures" in refusal(tmp_path / "a.png", bytes(good))


def test_a_turned_photograph_is_refused(tmp_path: Path) -> None:
    exif = b"Exif\0\0MM\0*\0\0\0\x08" + struct.pack(">HHHIHHI", 1, 274, 3, 1, 6, 0, 0)
    plain = cv2.imencode(".jpg", GREY)[1].tobytes()
    turned = plain[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + plain[2:]
    assert "orientation is 6" in refusal(tmp_path / "a.jpg", turned)


def test_a_png_of_a_few_bytes_that_needs_gigabytes_is_not_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def decoded(*_: object) -> None:
        raise AssertionError("it was decoded")

    head = b"IHDR" + struct.pack(">IIBBBBB", 30_000, 30_000, 16, 6, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head))
    monkeypatch.setattr(cv2, "imdecode", decoded)
    assert "30000 x 30000 px is too large" in refusal(tmp_path / "a.png", data)


@pytest.mark.parametrize(("factor", "bits"), [(1, 8), (4, 10), (16, 12)])
def test_the_depth_of_low_bits_is_named(tmp_path: Path, factor: int, bits: int) -> None:
    values = np.asarray((np.arange(64).reshape(8, 8) * 4 + 3) * factor, np.uint16)
    cv2.imwrite(str(tmp_path / "a.png"), values)
    (warning,) = read_marked(tmp_path / "a.png")[1]
    assert f"only {bits} of 16 bits are used (highest value {255 * factor} of 65535)" in warning
    cv2.imwrite(str(tmp_path / "b.png"), values * (256 // factor))
    assert read_marked(tmp_path / "b.png")[1] == ()


@given(st.binary(max_size=200), st.sampled_from([b"", b"II*\0", b"MM\0*", b"II+\0", b"\xff\xd8", b"BM"]))
def test_the_head_of_anything_is_read_without_a_fault(data: bytes, begin: bytes) -> None:
    read_header(begin + data)


@given(st.lists(st.tuples(st.integers(0, 199), st.integers(0, 255)), min_size=1, max_size=4))
def test_a_damaged_file_is_refused_or_read(
    tmp_path_factory: pytest.TempPathFactory, changes: list[tuple[int, int]]
) -> None:
    path = tmp_path_factory.mktemp("image") / "a.tif"
    raw = bytearray(tiff())
    for place, value in changes:
        raw[place % len(raw)] = value
    path.write_bytes(bytes(raw))
    try:
        image, _ = read_marked(path)
    except ImageError:
        return
    assert image.dtype == np.uint8


def test_hidden_files_and_thumbnails_are_passed_over(tmp_path: Path) -> None:
    good = (FRAMES / label_with("OK")["frame"]).read_bytes()
    for name in ("p1.png", "._p1.png", ".ipynb_checkpoints/p1-checkpoint.png", "@eaDir/p1.png/THUMB.jpg"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(good)
    assert [source.name for source in sources([tmp_path])] == ["p1.png"]
    assert len(sources([tmp_path / "._p1.png"])) == 1, "a file that is named is judged"
