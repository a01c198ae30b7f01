"""A class is found in what the platforms of courses export, and so is who handed in what."""

import struct
import zipfile

import pytest

from robocop_grading.classroom.hand_ins import collect
from robocop_grading.errors import GradingSetupError
from robocop_grading.files.exports import Person, class_folder, holds_class, people

SERVER = "robocop_goto_as.py"
METADATA = """
submission_1:
  :submitters:
  - {":name": Anna Nováková, ":sid": "0042", ":email": anna@example.edu}
  - {":name": Ben, ":email": ben@example.edu}
  :score: 0.0
submission_2:
  :submitters: [{":name": Carl}]
"""


def made(top, *files):
    """The folder, with these files in it."""
    for file in files:
        path = top / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(METADATA if path.suffix == ".yml" else "pass")
    return top


MOODLE = [f"{name}_assignsubmission_file_/{SERVER}" for name in ("Novak Jan_10001", "Nový Petr_10002")]
FLAT_MOODLE = [f"{name}_assignsubmission_file_lab03.zip" for name in ("Novak Jan_10001", "Nový Petr_10002")]
GRADESCOPE = [f"submission_{number}/{SERVER}" for number in (1, 2)] + ["submission_metadata.yml"]
GITHUB = [f"lab03-{name}/{file}" for name in ("anna", "ben") for file in (".git/HEAD", "src/my_server.py")]
GOOGLE = ["Anna.zip", "Ben.zip", "late/lab.py"]
EXPORTS = {"moodle": MOODLE, "files": FLAT_MOODLE, "gradescope": GRADESCOPE, "github": GITHUB, "google": GOOGLE}


@pytest.mark.parametrize("above", ["", "assignment_7_export", "top/assignment_7_export"])
@pytest.mark.parametrize("files", EXPORTS.values(), ids=EXPORTS)
def test_export_of_a_platform_is_read_as_a_class_also_in_a_folder_of_its_own(above, files, tmp_path):
    made(tmp_path / "class" / above, *files)
    folder = class_folder(tmp_path / "class", ("grades.csv",))
    assert folder == tmp_path / "class" / above
    expected = {file.partition("/")[0].partition("_assign")[0] for file in files} - {"submission_metadata.yml"}
    assert set(collect(folder)[0]) == expected


@pytest.mark.parametrize(
    "files",
    [
        [f"novak/{SERVER}"],
        [f"novak/server/{SERVER}", "novak/bridge/robocop_rviz_goto_ac.py"],
        [f"ws/src/aro_robocop_goto_as/scripts/{SERVER}", "ws/src/my_msgs/package.xml"],
        [f"lab/scripts/{SERVER}", f"lab/backup/{SERVER}"],
        [f"Novak Jan_10001_assignsubmission_file_/{name}" for name in ("lab.zip", "lab_2.zip")],
        ["lab.zip"],
    ],
)
def test_folder_with_one_hand_in_stays_a_class_of_one(files, tmp_path):
    assert class_folder(made(tmp_path, *files), ()) == tmp_path


def test_export_that_is_still_packed_is_refused_with_the_command_that_unpacks_it(tmp_path):
    export = tmp_path / "class" / "Lab 03.zip"
    export.parent.mkdir()
    with zipfile.ZipFile(export, "w") as archive:
        archive.writestr(f"top/{MOODLE[0]}", "pass")
    with pytest.raises(GradingSetupError, match="expected a folder with a folder, an archive"):
        class_folder(tmp_path / "nothing", ())
    for given in (export, export.parent):
        with pytest.raises(GradingSetupError) as error:
            class_folder(given, ())
        assert str(error.value).endswith(f"; unpack it first: unzip -q -d FOLDER '{export}'")


def test_damaged_archive_is_a_hand_in_like_others(tmp_path):
    (tmp_path / "lab.zip").write_bytes(struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 1, 1, 46, 0, 0))  # only an end record
    assert class_folder(tmp_path, ()) == tmp_path


@pytest.mark.parametrize("files, expected", [(GOOGLE[:2], True), (GITHUB, True), ([SERVER, "a/b.py"], False)])
def test_folder_holds_a_class_if_several_of_its_entries_are_hand_ins(files, expected, tmp_path):
    assert holds_class(made(tmp_path, *files)) == expected


def test_people_have_the_names_and_numbers_of_their_platform(tmp_path):
    assert people(made(tmp_path / "moodle", *MOODLE, "Carl/a.py")) == {
        "Novak Jan_10001": Person("Participant 10001", "Novak Jan"),
        "Nový Petr_10002": Person("Participant 10002", "Nový Petr"),
    }
    assert people(made(tmp_path / "gradescope", *GRADESCOPE)) == {
        "submission_1": Person("", "Anna Nováková, Ben", "anna@example.edu, ben@example.edu", "0042"),
        "submission_2": Person("", "Carl"),
    }
    (tmp_path / "gradescope" / "submission_metadata.yml").write_text("submission_1: {}")
    with pytest.raises(GradingSetupError, match="metadata.yml: expected submissions with :submitters:, as Gradescope"):
        people(tmp_path / "gradescope")
