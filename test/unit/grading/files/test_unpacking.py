"""What is in archives is found, as platforms and systems make them; nothing is written outside of its folder."""

import io
import stat
import tarfile
import zipfile
from pathlib import Path

import pytest

from robocop_grading.cli import unpacked_path
from robocop_grading.errors import GradingError
from robocop_grading.files import archives, unpacking
from robocop_hosting import tree

SERVER = "robocop_goto_as.py"


def zipped(files, flags=0):
    """A zip with these files; `flags` as Windows or macOS set them."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            info = zipfile.ZipInfo(name)
            info.flag_bits |= flags
            archive.writestr(info, content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def tarred(files, compression=""):
    """A tar archive with these files; a TarInfo as content stands for itself."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode=f"w:{compression}") as archive:
        for name, content in files.items():
            info = content if isinstance(content, tarfile.TarInfo) else tarfile.TarInfo(name)
            if info is not content:
                info.size = len(content)
            archive.addfile(info, io.BytesIO(b"" if info is content else content))
    return buffer.getvalue()


def encrypted(files):
    """A zip with this file that says that it is encrypted."""
    raw = bytearray(zipped(files))
    for flags in (6, raw.index(b"PK\1\2") + 8):
        raw[flags] |= 1
    return bytes(raw)


def long_list(files):
    """A zip with these files that says that its list of entries is very long."""
    raw = bytearray(zipped(files))
    raw[-10:-6] = (2**23).to_bytes(4, "little")
    return bytes(raw)


def link(name, target, kind=tarfile.SYMTYPE):
    """A link in a tar archive."""
    info = tarfile.TarInfo(name)
    info.type, info.linkname = kind, target
    return info


def written(top, files):
    """The folder with these files."""
    top.mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        (top / path).parent.mkdir(parents=True, exist_ok=True)
        (top / path).write_bytes(content() if callable(content) else content)
    return top


@pytest.fixture
def unpacked(tmp_path):
    """Write a folder of files, unpack it; then the paths of files and links below it."""

    def run(files, name="anna"):
        out = tmp_path / "out"
        unpacking.unpack(written(tmp_path / "class" / name, files)).write(out / name)
        return sorted(str(path.relative_to(out / name)) for path in (out / name).rglob("*") if not path.is_dir())

    return run


ONE = {f"lab/{SERVER}": b"pass"}


@pytest.mark.parametrize(
    "name, make",
    [
        ("lab.zip", lambda: zipped(ONE)),
        ("LAB.ZIP", lambda: zipped(ONE)),
        ("lab.tar", lambda: tarred(ONE)),
        ("lab.tar.gz", lambda: tarred(ONE, "gz")),
        ("lab.tgz", lambda: tarred(ONE, "gz")),
        ("lab.tar.bz2", lambda: tarred(ONE, "bz2")),
        ("lab.tar.xz", lambda: tarred(ONE, "xz")),
        ("wrongly_named.zip", lambda: tarred(ONE, "gz")),
        ("wrongly_named.tar.gz", lambda: tarred(ONE)),
        ("in/a/folder (1).zip", lambda: zipped(ONE)),
    ],
)
def test_archive_beside_other_files_is_unpacked(name, make, unpacked):
    assert unpacked({name: make(), "report.pdf": b""}) == sorted([f"{name}/lab/{SERVER}", "report.pdf"])


@pytest.mark.parametrize(
    "outer, inner, make",
    [
        ("eve.zip", "in.zip", lambda: zipped({"in.zip": zipped(ONE)})),
        ("eve.zip", "a/in.tgz", lambda: zipped({"a/in.tgz": tarred(ONE, "gz")})),
        ("eve.tgz", "in.zip", lambda: tarred({"in.zip": zipped(ONE)}, "gz")),
        ("eve.tar", "in.zip", lambda: tarred({"in.zip": zipped(ONE)})),  # zipfile takes the outer one for the inner one
    ],
)
def test_archive_in_an_archive_is_unpacked(outer, inner, make, unpacked):
    assert unpacked({outer: make()}) == [f"{outer}/{inner}/lab/{SERVER}"]


@pytest.mark.parametrize(
    "beside",
    [{SERVER: b""}, {"scripts/robocop_goto_as (1).py": b""}, {"package.xml": b""}, {"robocop_rviz_goto_ac-1.py": b""}],
)
def test_archive_beside_what_is_graded_is_named_and_not_unpacked(beside, tmp_path):
    (tmp_path / "eve.zip").write_bytes(zipped({**beside, "old/backup.zip": zipped(ONE), "old.rar": b""}))
    assert unpacking.unpack(tmp_path / "eve.zip").notes == [
        "old/backup.zip was not unpacked: what is graded is outside of it",
        "old.rar was not unpacked: expected zip or tar",
    ]


@pytest.mark.parametrize(
    "files, problem",
    [
        ({}, "the folder is empty"),
        ({"build/x.py": b"", "__MACOSX/a.py": b""}, "no file in it, but for build products"),
        ({"report.pdf": b""}, "no package and no Python file in it, only report.pdf"),
        (
            {"lab.rar": b"", "a.txt": b""},
            "no package and no Python file in it, only a.txt, lab.rar; lab.rar was not unpacked",
        ),
        ({"lab.ipynb": b"", ".DS_Store": b"", ".ipynb_checkpoints/x.py": b""}, "only lab.ipynb"),
        ({"a.zip": tree.POINTER}, "a.zip: this is a pointer of Git LFS, the file itself was not handed in"),
        ({"a.zip": b"no zip"}, "a.zip: neither a zip nor a tar archive"),
        ({"a.tar.gz": lambda: tarred(ONE, "gz")[:-20]}, "a.tar.gz: can't be unpacked: Compressed file ended"),
        (
            {"a.zip": lambda: zipped({SERVER: bytes(10_001)})},
            "a.zip: larger than 0 MB; the largest file in it is a.zip/",
        ),
        (dict.fromkeys(["a.zip", "b.zip"], lambda: zipped({SERVER: bytes(6_000)})), "b.zip: larger than 0 MB"),
        ({"a.zip": lambda: encrypted({SERVER: b"pass"})}, "encrypted, password required"),
        ({"a.zip": lambda: zipped({f"{'d/' * 101}{SERVER}": b""})}, "a.zip: expected at most 100 nested folders"),
        ({"a.zip": lambda: long_list(ONE)}, "a.zip: expected at most 5000 files"),
        ({"a.tgz": lambda: tarred({SERVER: bytes(10_001)}, "gz")}, "a.tgz: larger than 0 MB"),
        ({"a.tgz": lambda: tarred({"build/x": bytes(1024**2)}, "gz")}, "a.tgz: larger than 1 MB"),
        (
            {"a.tgz": lambda: tarred(dict.fromkeys(map(str, range(21)), b""), "gz")},
            "a.tgz: expected at most 5000 files",
        ),
    ],
)
def test_what_can_not_be_graded_states_what_was_found(files, problem, tmp_path, monkeypatch):
    monkeypatch.setattr(archives, "MAX_BYTES", 10_000)
    monkeypatch.setattr(archives, "MAX_PACKED", 1024**2)
    monkeypatch.setattr(archives, "MAX_ENTRIES", 20)
    with pytest.raises(GradingError) as error:
        unpacking.unpack(written(tmp_path / "eve", files))
    assert problem in str(error.value)


def test_archives_one_in_another_are_unpacked_to_a_sensible_depth(tmp_path):
    content = zipped(ONE)
    for _ in range(unpacking.MAX_NESTED + 1):
        content = zipped({"in.zip": content})
    (tmp_path / "eve.zip").write_bytes(content)
    with pytest.raises(GradingError, match="only in.zip/in.zip/in.zip/in.zip; .* more than three in one another"):
        unpacking.unpack(tmp_path / "eve.zip")


@pytest.mark.parametrize(
    "files",
    [
        {"../evil.py": b""},
        {"/tmp/evil.py": b""},
        {"link": link("link", "/tmp"), "link/evil.py": b""},
        {"link/evil.py": b"", "link": link("link", "/tmp")},
        {"pipe": link("pipe", "", tarfile.FIFOTYPE)},
    ],
)
def test_archive_that_would_write_or_read_elsewhere_is_refused(files, tmp_path):
    (tmp_path / "eve.tar").write_bytes(tarred(files))
    (tmp_path / "eve.zip").write_bytes(zipped(dict.fromkeys(["x.py", "../evil.py"], b"")))
    for name in ("eve.tar", "eve.zip"):
        with pytest.raises(GradingError):
            unpacking.unpack(tmp_path / name)


def test_hard_link_out_of_an_archive_is_named_with_where_it_leads(tmp_path):
    (tmp_path / "eve.tar").write_bytes(tarred({"hard": link("hard", "/etc/passwd", tarfile.LNKTYPE)}))
    with pytest.raises(GradingError, match="hard: a hard link to /etc/passwd, which is not in it"):
        unpacking.unpack(tmp_path / "eve.tar")


@pytest.mark.parametrize("pack", [zipped, tarred, None])
def test_large_video_beside_a_solution_is_left_out_and_named(pack, tmp_path):
    files = {**ONE, "lab/my drive.MP4": bytes(3 * 1024**2), "lab/icon.png": b"small"}
    top = written(tmp_path / "class", {"lab.zip": pack(files)} if pack else files)
    found, prefix = unpacking.unpack(top), "lab.zip/" if pack else ""
    kept = {path for path, entry in found.entries.items() if stat.S_ISREG(entry.mode)}
    assert kept == {f"{prefix}lab/{SERVER}", f"{prefix}lab/icon.png"}
    told = f"{prefix}lab/my drive.MP4 (3 MB) was left out: a video, a recording or an image is not graded"
    assert found.notes == [told]


@pytest.mark.parametrize("target", ["", "b\0c"])
def test_link_that_no_disk_can_hold_is_refused(target, tmp_path):
    found = archives.Unpacked()
    found.entries = {"": archives.Entry(archives.FOLDER), "a": archives.Entry(archives.LINK, target=target)}
    with pytest.raises(GradingError, match="can't be unpacked"):
        found.write(tmp_path / "eve")


def test_link_that_is_replaced_by_a_file_of_its_name_is_not_written_through(tmp_path, unpacked):
    assert unpacked({"eve.tar": tarred({"first": link(SERVER, str(tmp_path / "target")), SERVER: b""})})
    assert not (tmp_path / "target").exists()


def test_links_of_archives_stay_links_and_hard_links_become_files(tmp_path):
    files = {"src/CMakeLists.txt": link("src/CMakeLists.txt", "/opt/ros/toplevel.cmake"), SERVER: b"pass"}
    (tmp_path / "eve.tar").write_bytes(tarred({**files, "copy.py": link("copy.py", SERVER, tarfile.LNKTYPE)}))
    info = zipfile.ZipInfo("link.py")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
        archive.writestr(info, SERVER)
        archive.writestr(SERVER, "pass")
    for name in ("eve.tar", "eve.zip"):
        unpacking.unpack(tmp_path / name).write(tmp_path / "out" / name)
    out = tmp_path / "out"
    assert (out / "eve.tar" / "src" / "CMakeLists.txt").is_symlink() and (out / "eve.tar" / "copy.py").is_file()
    assert (out / "eve.zip" / "link.py").is_symlink() and (out / "eve.zip" / "link.py").read_text() == "pass"


@pytest.mark.parametrize(
    "encoding, name",
    [
        ("utf-8", "řízení.py"),  # as macOS' and Linux' zips may have it, without a flag
        ("cp852", "řízení.py"),
        ("ascii", "lab\\scripts\\a.py"),
    ],
)
def test_names_in_zips_are_those_that_their_authors_saw(encoding, name, unpacked):
    encoded = name.encode(encoding)
    raw = zipped({"x" * len(encoded): b"pass"}).replace(b"x" * len(encoded), encoded)
    assert unpacked({"lab.zip": raw}) == ["lab.zip/" + name.replace("\\", "/")]


def test_what_a_desktop_adds_is_left_out(unpacked):
    junk = dict.fromkeys(
        ["__MACOSX/lab/._a.py", "lab/._a.py", "lab/.DS_Store", "lab/.ipynb_checkpoints/a-checkpoint.py", "lab\\b\\"],
        b"",
    )
    assert unpacked({"lab.zip": zipped({**junk, "lab/a.py": b""})}) == ["lab.zip/lab/a.py"]
    assert unpacked({"lab.tar": tarred({"lab/._a.py": b"", "lab/a.py": b""})}, "ben") == ["lab.tar/lab/a.py"]


@pytest.mark.parametrize(
    "files, is_packed",
    [
        ({"lab.zip": b""}, True),
        ({"a/b/lab.tgz": b"", "report.pdf": b""}, True),
        ({"lab.zip": b"", SERVER: b""}, False),
        ({"lab.zip": b"", "ws/src/lab/package.xml": b""}, False),
        ({"server.py": b""}, False),
    ],
)
def test_only_a_folder_without_anything_to_grade_outside_of_its_archives_is_unpacked(files, is_packed, tmp_path):
    assert unpacking.is_packed(written(tmp_path, files)) is is_packed


def test_unpacked_file_can_be_read_by_everybody_whatever_its_owner_s_umask_was(tmp_path):
    (tmp_path / SERVER).touch(mode=0o600)
    unpacking.unpack(tmp_path / SERVER).write(tmp_path / "out.py")
    assert stat.S_IMODE((tmp_path / "out.py").stat().st_mode) == 0o644


def test_single_archive_is_graded_as_what_it_contains(tmp_path):
    folder, out = tmp_path / "class", tmp_path / "out"
    folder.mkdir()
    (folder / "lab.zip").write_bytes(zipped({**ONE, "lab/old.7z": b""}))
    path, notes = unpacked_path(str(folder / "lab.zip"), out, None)
    assert (Path(path) / "lab" / SERVER).read_text() == "pass"
    assert notes == ["lab/old.7z was not unpacked: expected zip or tar"]
    assert unpacked_path(str(folder), out, None)[0] == str(out / "class")
    (folder / "lab.rar").touch()
    with pytest.raises(GradingError, match="lab.rar: can't be unpacked: expected zip or tar"):
        unpacked_path(str(folder / "lab.rar"), out, None)
