"""What counts as a hand-in of a class, and when it has changed; test_unpacking.py tests what is in one."""

import os

import pytest

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading.classroom.hand_ins import collect, unpacked
from robocop_grading.errors import GradingError


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


def test_entries_of_one_participant_in_moodle_are_one_hand_in_and_online_text_is_none(tmp_path):
    server, bridge = "robocop_goto_as.py", "robocop_rviz_goto_ac.py"
    for file in ("Ben_2_assignsubmission_file_/lab/a.py", "Eva_3_assignsubmission_file/b.py", "Eva_3.py"):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).touch()
    for name in (f"file_{server}", f"file_{bridge}", "onlinetext_onlinetext.html"):
        (tmp_path / f"Novak Jan_1_assignsubmission_{name}").touch()
    (tmp_path / "Ben_2_assignsubmission_onlinetext_").mkdir()
    hand_ins, others = collect(tmp_path)
    assert [*hand_ins] == ["Ben_2", "Eva_3.py", "Eva_3", "Novak Jan_1"] and all(hand_ins.values())
    assert others == ["Ben_2_assignsubmission_onlinetext_", "Novak Jan_1_assignsubmission_onlinetext_onlinetext.html"]
    assert [*unpacked(tmp_path / "Novak Jan_1").entries] == ["", server, bridge]
    assert [*unpacked(tmp_path / "Ben_2").entries] == ["", "lab", "lab/a.py"]


@pytest.mark.parametrize("name", ["Eva_1_assignsubmission_file_", "Eva_1_assignsubmission_file_a.py"])
def test_part_of_a_hand_in_that_leads_elsewhere_is_refused(name, folder):
    (folder / name).symlink_to("anna")
    assert problem_of(folder / "Eva_1").startswith("a link: expected")


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
    for name in ("pipes", "large"):
        (tmp_path / name).mkdir()
    os.mkfifo(tmp_path / "pipes" / "pipe")
    with open(tmp_path / "large" / "hole", "wb") as hole:
        hole.truncate(10**12)
    assert problem_of(tmp_path / "pipes") == "pipe: expected a file, folder or link"
    assert problem_of(tmp_path / "large").startswith(
        "larger than 64 MB; the largest file in it is hole with 953674.3 MB"
    )


def test_a_folder_without_hand_ins_is_refused(tmp_path):
    with pytest.raises(GradingError, match="no hand-ins"):
        collect(tmp_path)
