"""Hand-ins of a class are collected and packed."""

import os
import shutil
import tempfile
import time
import warnings
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import GradingError, RobocopError
from robocop_grading.classroom.hand_ins import collect, packed
from robocop_grading.files import archives
from robocop_grading.files.packing import unpack


def problem_of(path):
    """Why a hand-in can't be packed."""
    with pytest.raises(RobocopError) as error:
        packed(path)
    return str(error.value)


def unpacked(path, folder):
    """A hand-in, packed and unpacked to a folder."""
    unpack(packed(path).archive, folder)
    return folder / path.name


def test_folders_and_python_files_are_hand_ins_and_are_unpacked_unchanged(folder, tmp_path):
    hand_ins, others = collect(folder)
    assert [hand_in.name for hand_in in hand_ins if hand_in.digest] == ["anna", "ben.py"]
    assert others == []
    anna, ben = (unpacked(folder / name, tmp_path / "out") for name in ("anna", "ben.py"))
    assert (anna / "scripts" / "robocop_goto_as.py").read_text() == "one"
    assert not (anna / "build").exists()
    assert ben.read_text() == "two"


def test_whatever_else_is_in_the_folder_has_a_row_with_the_reason(folder):
    for name in ("eve.rar", "fred.7z", "gina.ipynb", "hana.py.txt", "README", "grades.csv", "submission_metadata.yml"):
        (folder / name).write_text("")
    hand_ins, others = collect(folder, ("grades.csv",))
    unread = [hand_in.path for hand_in in hand_ins if not hand_in.digest]
    problems = {path.name: problem_of(path).partition(": expected a folder, a zip or tar")[0] for path in unread}
    kinds = {"eve.rar": ".rar", "fred.7z": ".7z", "gina.ipynb": ".ipynb", "hana.py.txt": ".txt", "list.csv": ".csv"}
    expected = {name: f"a {kind} file" for name, kind in kinds.items()}
    assert problems == {**expected, "README": "a nameless file", "link.py": "a link"}
    assert others == ["grades.csv", "submission_metadata.yml"], "this grader's and Gradescope's"


def test_digest_depends_on_contents_but_not_on_times(folder):
    before, _ = collect(folder)
    os.utime(folder / "ben.py", (0, 0))
    assert [hand_in.digest for hand_in in collect(folder)[0]] == [hand_in.digest for hand_in in before]
    (folder / "anna" / "scripts" / "robocop_goto_as.py").write_text("One")
    after, _ = collect(folder)
    assert after[0].digest != before[0].digest and after[1].digest == before[1].digest


def test_a_link_is_packed_as_a_link(tmp_path):
    (tmp_path / "class" / "eve").mkdir(parents=True)
    (tmp_path / "secret").write_text("points")
    (tmp_path / "class" / "eve" / "run.py").touch()
    (tmp_path / "class" / "eve" / "link").symlink_to(tmp_path / "secret")
    assert (unpacked(tmp_path / "class" / "eve", tmp_path / "out") / "link").is_symlink()
    assert b"points" not in packed(tmp_path / "class" / "eve").archive


def test_zip_counts_as_the_folder_that_it_contains(tmp_path):
    (tmp_path / "class" / "eve").mkdir(parents=True)
    (tmp_path / "class" / "eve" / "run.py").write_text("one")
    (tmp_path / "class" / "eve" / "run.py").chmod(0o755)
    digest = packed(tmp_path / "class" / "eve").digest
    shutil.make_archive(str(tmp_path / "zipped" / "eve"), "zip", tmp_path / "class" / "eve")
    (tmp_path / "moodle" / "eve").mkdir(parents=True)
    shutil.copy(tmp_path / "zipped" / "eve.zip", tmp_path / "moodle" / "eve" / "lab.zip")
    assert packed(tmp_path / "zipped" / "eve.zip").digest == digest
    for path, inside in (("zipped/eve.zip", "run.py"), ("moodle/eve", "lab.zip/run.py")):
        script = unpacked(tmp_path / path, tmp_path / "out" / path) / inside
        assert script.read_text() == "one" and os.access(script, os.X_OK)


@pytest.mark.parametrize(
    "name, megabytes, problem",
    [
        ("../../evil.py", 0, "../../evil.py: expected a path within the archive"),
        ("/etc/evil.py", 0, "/etc/evil.py: expected a path within the archive"),
        ("bomb.py", 65, "larger than 64 MB"),
        ("", 0, "neither a zip nor a tar archive"),
    ],
)
def test_malicious_or_broken_zip_is_refused(name, megabytes, problem, tmp_path):
    with open(tmp_path / "eve.zip", "wb") as file:
        if not name:
            file.write(b"PK no zip at all")
        else:
            with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr(name, bytes(megabytes * 1024**2))
    assert problem_of(tmp_path / "eve.zip") == problem


def test_hand_in_that_cannot_be_packed_states_the_reason(tmp_path):
    (tmp_path / "pipes" / "eve").mkdir(parents=True)
    os.mkfifo(tmp_path / "pipes" / "eve" / "pipe")
    assert problem_of(tmp_path / "pipes" / "eve") == "pipe: expected a file, folder or link"
    (tmp_path / "large" / "eve").mkdir(parents=True)
    with open(tmp_path / "large" / "eve" / "hole", "wb") as hole:
        hole.truncate(10**12)
    assert problem_of(tmp_path / "large" / "eve") == "larger than 64 MB"


def test_a_folder_without_hand_ins_is_refused(tmp_path):
    with pytest.raises(GradingError, match="no hand-ins"):
        collect(tmp_path)
    with pytest.raises(GradingError, match="expected a folder with a folder, a zip or tar archive, or a Python file"):
        collect(tmp_path / "nothing")


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    # zipfile ends a name at its first NUL, and can't write an empty one.
    files=st.dictionaries(st.text(min_size=1).filter(lambda name: name[0] != "\0"), st.binary(max_size=20), max_size=5),
    noise=st.binary(max_size=30),
)
def test_no_zip_stops_the_class(files, noise, tmp_path):
    tmp_path = Path(tempfile.mkdtemp(dir=tmp_path))
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a name that occurs twice
        for name, content in files.items():
            archive.writestr(name.encode("utf-8", "replace").decode(), content)
    (tmp_path / "carl.zip").write_bytes(noise)
    carl, eve = collect(tmp_path)[0]
    assert problem_of(carl.path)
    assert eve.digest or problem_of(eve.path)


@pytest.mark.parametrize("kind", ["folder", "zip"])
def test_deeply_nested_hand_in_states_the_reason(kind, tmp_path):
    nested = "/".join("d" * 1500)
    if kind == "zip":
        with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
            archive.writestr(f"{nested}/file", "")
    else:
        # No deeper than pytest, which removes the folder in a later run, can recurse; test_tree.py goes deeper.
        (tmp_path / "eve" / nested[:300]).mkdir(parents=True)
    assert "expected at most 100 nested folders" in problem_of(next(tmp_path.iterdir()))


PATIENCE = 20.0  # [s, wall]; reading 150,000 entries takes minutes
TOO_MANY = "expected at most 5000 files and folders"


@pytest.mark.parametrize(
    "number, name", [(150_000, "{}"), (5_001, "{}"), (5_001, "a/{}"), (20_000, f"{'x' * 240}{{}}")]
)
def test_zip_with_too_many_entries_is_refused_soon(number, name, tmp_path):
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
        for index in range(number):
            archive.writestr(zipfile.ZipInfo(name.format(index)), b"")
    started = time.monotonic()
    assert problem_of(tmp_path / "eve.zip") == TOO_MANY
    assert time.monotonic() - started < PATIENCE


def test_folder_with_too_many_entries_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(archives, "MAX_ENTRIES", 4)
    (tmp_path / "eve").mkdir()
    for index in range(3):
        (tmp_path / "eve" / f"{index}.py").touch()
    assert packed(tmp_path / "eve").digest
    (tmp_path / "eve" / "4").touch()
    assert problem_of(tmp_path / "eve") == TOO_MANY


def test_zip_with_as_many_entries_as_a_hand_in_may_have_is_packed(tmp_path):
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
        for index in range(4_999):  # and their folder
            archive.writestr(zipfile.ZipInfo(f"a/{index}.py"), b"")
    assert packed(tmp_path / "eve.zip").digest
