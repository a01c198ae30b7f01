"""What counts as a hand-in of a class, and when it has changed; test_unpacking.py tests what is in one."""

import os

import pytest

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading.classroom.hand_ins import collect, entries_of
from robocop_grading.errors import GradingError


def problem_of(path):
    """Why a hand-in can't be graded."""
    with pytest.raises(RobocopError) as error:
        entries_of(path)
    return str(error.value)


def test_folders_and_python_files_are_hand_ins_and_whatever_else_is_there_has_the_reason(folder):
    for name in ("eve.rar", "gina.ipynb", "hana.py.txt", "README", "grades.csv", "submission_metadata.yml"):
        (folder / name).write_text("")
    hand_ins, others = collect(folder, ("grades.csv",))
    assert [name for name, digest in hand_ins.items() if digest] == ["anna", "ben.py", "eve.rar"]
    unread = [folder / name for name, digest in hand_ins.items() if not digest]
    problems = {path.name: problem_of(path).partition(": expected a folder, an archive")[0] for path in unread}
    kinds = {"gina.ipynb": ".ipynb", "hana.py.txt": ".txt", "list.csv": ".csv"}
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
    assert len(entries_of(tmp_path / "Novak Jan_1")) == 2 and len(entries_of(tmp_path / "Ben_2")) == 1


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


def test_a_folder_without_hand_ins_is_refused(tmp_path):
    with pytest.raises(GradingError, match="no hand-ins"):
        collect(tmp_path)
