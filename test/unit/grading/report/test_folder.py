"""The folder that `--report` names is created or refused before anything is graded."""

from pathlib import Path

import pytest

from aro_robocop_goto_as.errors import GradingSetupError
from robocop_grading.report.folder import make_report_folder


def test_folder_is_created_with_its_parents(tmp_path):
    assert make_report_folder(tmp_path / "a" / "b").is_dir()
    assert make_report_folder(tmp_path / "a" / "b").is_dir(), "it may exist"


def test_folder_that_can_not_be_created_is_refused_with_its_name(tmp_path):
    (tmp_path / "file").write_text("")
    for folder in (Path("/proc/x"), tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(GradingSetupError, match=f"^the report can't be written to {folder}: "):
            make_report_folder(folder)
