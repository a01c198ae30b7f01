"""What is said of a submission before it runs."""

from pathlib import Path

import pytest

from robocop_grading import submission

SERVER = "import rospy\nrospy.init_node('lab')\nactionlib.SimpleActionServer('robocop_goto_as')\n"


@pytest.mark.parametrize("more, expected", [("Subscriber('/move_base_simple/goal')\n", 1), ("# move_base_simple\n", 0)])
def test_bridge_in_the_servers_script_is_not_graded_without_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, more: str, expected: int
) -> None:
    monkeypatch.setattr(submission, "lab_environment", lambda *_: {})
    (tmp_path / "lab.py").write_text(SERVER + more)
    notes = submission.prepare_submission(str(tmp_path), tmp_path, tmp_path, tmp_path, None).notes
    assert sum("lab.py has a bridge, too" in note for note in notes) == expected
