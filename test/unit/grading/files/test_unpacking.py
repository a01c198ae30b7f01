"""What is in archives is found, as platforms and systems make them; nothing is written outside of its folder."""

import io
import stat
import subprocess
import tarfile
import tempfile
import zipfile
import zlib
from pathlib import Path

import pytest

from robocop_grading.errors import GradingError
from robocop_grading.files import packing, unpacking

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


def archived(files, *options):
    """An archive with these files, as bsdtar makes it."""
    with tempfile.TemporaryDirectory() as folder:
        written(Path(folder), files)
        command = ["bsdtar", "-c", "-f", "-", *options, "-C", folder, *files]
        return subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout


def rar(files):
    """A rar archive with these files, which are not compressed."""

    def block(kind, flags, fields, data=b""):
        body = bytes([kind]) + (flags).to_bytes(2, "little") + (7 + len(fields)).to_bytes(2, "little") + fields
        return (zlib.crc32(body) & 0xFFFF).to_bytes(2, "little") + body + data

    content = b"Rar!\x1a\x07\x00" + block(0x73, 0, bytes(6))
    for name, data in files.items():
        size, check = len(data).to_bytes(4, "little"), zlib.crc32(data).to_bytes(4, "little")
        unix, date, version, stored = b"\3", bytes(4), b"\x14", b"\x30"
        rest = len(name).to_bytes(2, "little") + (0o100644).to_bytes(4, "little") + name.encode()
        content += block(0x74, 0x8000, size + size + unix + check + date + version + stored + rest, data)
    return content + block(0x7B, 0x4000, b"")


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
    """Packs a hand-in and unpacks it; the folder with it, and the notes."""

    def run(*entries):
        packing.pack(entries, tmp_path / "hand_in.tar")
        with open(tmp_path / "hand_in.tar", "rb") as packed:
            return tmp_path / "out", unpacking.unpack(packed, tmp_path / "out")

    return run


@pytest.fixture
def names(tmp_path, unpacked):
    """Writes a folder called anna, and unpacks it; the paths of files and links in it."""

    def run(files):
        out, _ = unpacked(written(tmp_path / "class" / "anna", files))
        return sorted(str(path.relative_to(out / "anna")) for path in (out / "anna").rglob("*") if not path.is_dir())

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
        ("lab.7z", lambda: archived(ONE, "--format=7zip")),
        ("lab.rar", lambda: rar(ONE)),
        ("wrongly_named.zip", lambda: tarred(ONE, "gz")),
        ("wrongly_named.tar.gz", lambda: tarred(ONE)),
        ("in/a/folder (1).zip", lambda: zipped(ONE)),
    ],
)
def test_archive_beside_other_files_is_unpacked(name, make, names):
    assert names({name: make(), "report.txt": b""}) == sorted([f"{name}/lab/{SERVER}", "report.txt"])


@pytest.mark.parametrize(
    "outer, inner, make",
    [
        ("eve.zip", "in.zip", lambda: zipped({"in.zip": zipped(ONE)})),
        ("eve.zip", "a/in.tgz", lambda: zipped({"a/in.tgz": tarred(ONE, "gz")})),
        ("eve.tgz", "in.zip", lambda: tarred({"in.zip": zipped(ONE)}, "gz")),
        ("eve.tar", "in.zip", lambda: tarred({"in.zip": zipped(ONE)})),
    ],
)
def test_archive_in_an_archive_is_unpacked(outer, inner, make, names):
    assert names({outer: make()}) == [f"{outer}/{inner}/lab/{SERVER}"]


@pytest.mark.parametrize(
    "beside",
    [{SERVER: b""}, {"scripts/robocop_goto_as (1).py": b""}, {"package.xml": b""}, {"robocop_rviz_goto_ac-1.py": b""}],
)
def test_archive_beside_what_is_graded_is_named_and_not_unpacked(beside, unpacked, tmp_path):
    (tmp_path / "eve.zip").write_bytes(zipped({**beside, "old/backup.zip": zipped(ONE), "old.gz": b""}))
    assert unpacked(tmp_path / "eve.zip")[1] == [
        "eve.zip/old/backup.zip was not unpacked: what is graded is outside of it",
        "eve.zip/old.gz was not unpacked: it is no archive",
    ]


@pytest.mark.parametrize(
    "files, problem",
    [
        ({}, "no file in it, but for build products"),
        ({"build/x.py": b"", "__MACOSX/a.py": b"", "drive.MP4": b""}, "no file in it, but for build products"),
        ({"a.zip": lambda: zipped({})}, "no file in it"),
        ({"report.txt": b""}, "no package and no Python file in it, only anna/report.txt"),
        ({"lab.py.gz": b"", "a.txt": b""}, "only anna/a.txt, anna/lab.py.gz; anna/lab.py.gz was not unpacked"),
        ({"lab.ipynb": b"", ".DS_Store": b"", ".ipynb_checkpoints/x.py": b""}, "only anna/lab.ipynb"),
        ({"a.zip": b"no zip"}, "anna/a.zip: can't be unpacked: Error opening archive: Unrecognized archive format"),
        ({"a.tar.gz": lambda: tarred(ONE, "gz")[:-20]}, "anna/a.tar.gz: can't be unpacked: .* truncated gzip input"),
        (
            {"a.zip": lambda: archived(ONE, "--format=zip", "--options=zip:encryption=traditional", "--passphrase=x")},
            "anna/a.zip: can't be unpacked: lab/robocop_goto_as.py: Incorrect passphrase",
        ),
    ],
)
def test_what_can_not_be_graded_states_what_was_found(files, problem, tmp_path, unpacked):
    with pytest.raises(GradingError, match=problem):
        unpacked(written(tmp_path / "anna", files))


def test_archives_one_in_another_are_unpacked_to_a_sensible_depth(tmp_path, unpacked):
    content = zipped(ONE)
    for _ in range(unpacking.MAX_NESTED):
        content = zipped({"in.zip": content})
    (tmp_path / "eve.zip").write_bytes(content)
    with pytest.raises(GradingError, match="only eve.zip/in.zip/in.zip/in.zip; .* more than three in one another"):
        unpacked(tmp_path / "eve.zip")


@pytest.mark.parametrize("content", [zipped, tarred])
@pytest.mark.parametrize("path", ["../evil.py", "/evil.py", "link/evil.py"])
def test_archive_writes_nothing_outside_of_its_folder(content, path, tmp_path, unpacked):
    beside = {"link": link("link", str(tmp_path))} if content is tarred else {}
    name = path if path[0] != "/" else f"{tmp_path}{path}"
    (tmp_path / "eve.zip").write_bytes(content({**beside, name: b""}))
    try:
        unpacked(tmp_path / "eve.zip")
    except GradingError as error:
        assert "can't be unpacked" in str(error)
    found = [path for path in tmp_path.rglob("evil.py") if tmp_path / "out" / "eve.zip" not in path.parents]
    assert found == []


def test_what_is_too_large_is_refused_before_it_is_unpacked(tmp_path):
    with open(tmp_path / "hole", "wb") as hole:
        hole.truncate(10**12)
    with pytest.raises(GradingError, match="larger than 256 MB, without build products, videos and recordings"):
        packing.pack([tmp_path / "hole"], tmp_path / "hand_in.tar")


def test_link_that_leads_to_what_was_not_handed_in_is_named(tmp_path, unpacked):
    files = {SERVER: link(SERVER, "/home/anna/x.py"), "a.py": b"", ".#a.py": link(".#a.py", "an editor's")}
    (tmp_path / "eve.tar").write_bytes(tarred(files))
    told = f"eve.tar/{SERVER} is a link to /home/anna/x.py, which was not handed in: put the file itself in its place"
    assert unpacked(tmp_path / "eve.tar")[1] == [told]


def test_links_stay_links_and_hard_links_become_files_and_pipes_are_left_out(tmp_path, unpacked):
    files = {"src/CMakeLists.txt": link("src/CMakeLists.txt", "/opt/ros/toplevel.cmake"), SERVER: b"pass"}
    files["pipe"] = link("pipe", "", tarfile.FIFOTYPE)
    (tmp_path / "eve.tar").write_bytes(tarred({**files, "copy.py": link("copy.py", SERVER, tarfile.LNKTYPE)}))
    info = zipfile.ZipInfo("link.py")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
        archive.writestr(info, "a.py")
        archive.writestr("a.py", "pass")
    out, _ = unpacked(tmp_path / "eve.tar", tmp_path / "eve.zip")
    assert (out / "eve.tar" / "src" / "CMakeLists.txt").is_symlink() and (out / "eve.tar" / "copy.py").is_file()
    assert not (out / "eve.tar" / "pipe").exists()
    assert (out / "eve.zip" / "link.py").is_symlink() and (out / "eve.zip" / "link.py").read_text() == "pass"


@pytest.mark.parametrize(
    "encoding, name",
    [
        ("utf-8", "řízení.py"),  # as macOS' and Linux' zips may have it, without a flag
        ("cp852", "řízení.py"),
        ("ascii", "lab\\scripts\\a.py"),
    ],
)
def test_names_in_zips_are_those_that_their_authors_saw(encoding, name, names):
    encoded = name.encode(encoding)
    raw = zipped({"x" * len(encoded): b"pass"}).replace(b"x" * len(encoded), encoded)
    assert names({"lab.zip": raw}) == ["lab.zip/" + name.replace("\\", "/")]


def test_what_a_desktop_adds_and_videos_are_left_out(names):
    junk = ["__MACOSX/lab/._a.py", "lab/._a.py", "lab/.DS_Store", "lab/.ipynb_checkpoints/a.py", "lab\\b\\", "x.MP4"]
    more = {**dict.fromkeys(junk, b""), "lab/a.py": b"", "lab/icon.png": b""}
    files = {"lab.zip": zipped(more), "lab.tar": tarred({"lab/._b.py": b"", "lab/b.py": b""}), "my drive.bag": b""}
    assert names(files) == ["lab.tar/lab/b.py", "lab.zip/lab/a.py", "lab.zip/lab/icon.png"]


def test_entries_of_one_participant_in_moodle_have_the_names_of_their_files(tmp_path, unpacked):
    files = {f"Novak Jan_1_assignsubmission_file_{SERVER}": b"pass", "Novak Jan_1_assignsubmission_file_/lab/a.py": b""}
    out, _ = unpacked(*sorted(written(tmp_path / "class", files).iterdir()))
    assert {path.name for path in out.iterdir()} == {SERVER, "lab"}


def test_unpacked_file_can_be_read_by_everybody_whatever_its_owner_s_umask_was(tmp_path, unpacked):
    (tmp_path / SERVER).touch(mode=0o600)
    (tmp_path / "lab").mkdir(mode=0o700)
    out, _ = unpacked(tmp_path / SERVER, tmp_path / "lab")
    assert [stat.S_IMODE((out / name).stat().st_mode) for name in (SERVER, "lab")] == [0o644, 0o755]
