"""Records as files."""

from pathlib import Path

from grading_records import RIGHT

from robocop_grading import record as rec


def test_record_is_unchanged_by_writing_and_reading(tmp_path: Path) -> None:
    rec.write(RIGHT, tmp_path / "a.record")
    assert rec.read(rec.Record, tmp_path / "a.record") == RIGHT
