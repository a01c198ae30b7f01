"""What counts as a hand-in of a class, and when it has changed; test_unpacking.py tests what is in one."""

import os
import tempfile
import time
import warnings
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import GradingError, RobocopError
from robocop_grading.classroom.hand_ins import collect, unpacked
from robocop_grading.files import archives


def problem_of(path):
    """Why a hand-in can't be unpacked."""
    with pytest.raises(RobocopError) as error:
        unpacked(path)
    return str(error.value)


def test_folders_and_python_files_are_hand_ins_and_whatever_else_is_there_has_the_reason(folder):
    for name in ("eve.rar", "fred.7z", "gina.ipynb", "hana.py.txt", "README", "grades.csv", "submission_metadata.yml"):
        (folder / name).write_text("")
    hand_ins, others = collect(folder, ("grades.csv",))
    assert [name for name, digest in hand_ins.items() if digest] == ["anna", "ben.py"]
    unread = [folder / name for name, digest in hand_ins.items() if not digest]
    problems = {path.name: problem_of(path).partition(": expected a folder, a zip or tar")[0] for path in unread}
    kinds = {"eve.rar": ".rar", "fred.7z": ".7z", "gina.ipynb": ".ipynb", "hana.py.txt": ".txt", "list.csv": ".csv"}
    expected = {name: f"a {kind} file" for name, kind in kinds.items()}
    assert problems == {**expected, "README": "a file without a suffix", "link.py": "a link"}
    assert others == ["grades.csv", "submission_metadata.yml"], "this grader's and Gradescope's"


def test_digest_depends_on_contents_but_not_on_times(folder):
    before, _ = collect(folder)
    os.utime(folder / "ben.py", (0, 0))
    assert collect(folder)[0] == before
    (folder / "anna" / "scripts" / "robocop_goto_as.py").write_text("One")
    after, _ = collect(folder)
    assert after["anna"] != before["anna"] and after["ben.py"] == before["ben.py"]


def test_folder_is_unpacked_with_its_links_and_without_what_was_built(folder, tmp_path):
    (tmp_path / "secret").write_text("points")
    (folder / "anna" / "link").symlink_to(tmp_path / "secret")
    found, anna = unpacked(folder / "anna"), tmp_path / "out"
    found.write(anna)
    assert (anna / "scripts" / "robocop_goto_as.py").read_text() == "one"
    assert (anna / "link").is_symlink() and "points" not in str(found.entries) and not (anna / "build").exists()


def test_what_can_not_be_read_from_a_folder_states_the_reason(tmp_path):
    for name in ("pipes", "large", "deep/" + "/".join("d" * 300)):
        (tmp_path / name).mkdir(parents=True)
    os.mkfifo(tmp_path / "pipes" / "pipe")
    with open(tmp_path / "large" / "hole", "wb") as hole:
        hole.truncate(10**12)
    assert problem_of(tmp_path / "pipes") == "pipe: expected a file, folder or link"
    assert problem_of(tmp_path / "large") == "larger than 64 MB"
    assert "expected at most 100 nested folders" in problem_of(tmp_path / "deep")


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
    hand_ins, _ = collect(tmp_path)
    assert list(hand_ins) == ["carl.zip", "eve.zip"]
    assert problem_of(tmp_path / "carl.zip")
    assert hand_ins["eve.zip"] or problem_of(tmp_path / "eve.zip")


TIMEOUT = 20.0  # [s, wall]; reading 150,000 entries takes minutes
TOO_MANY = "expected at most 5000 files and folders"


@pytest.mark.parametrize("number, name", [(150_000, "{}"), (5_001, "a/{}"), (20_000, f"{'x' * 240}{{}}")])
def test_zip_with_too_many_entries_is_refused_soon(number, name, tmp_path):
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
        for index in range(number):
            archive.writestr(zipfile.ZipInfo(name.format(index)), b"")
    started = time.monotonic()
    assert problem_of(tmp_path / "eve.zip") == TOO_MANY
    assert time.monotonic() - started < TIMEOUT


def test_hand_in_has_as_many_entries_as_it_may_have(tmp_path, monkeypatch):
    monkeypatch.setattr(archives, "MAX_ENTRIES", 4)
    (tmp_path / "eve").mkdir()
    with zipfile.ZipFile(tmp_path / "carl.zip", "w") as archive:
        for index in range(3):  # and their folder
            (tmp_path / "eve" / f"{index}.py").touch()
            archive.writestr(f"{index}.py", b"")
    assert all(collect(tmp_path)[0].values())
    (tmp_path / "eve" / "4").touch()
    assert problem_of(tmp_path / "eve") == TOO_MANY
