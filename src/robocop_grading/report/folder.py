"""The folder that --report names, checked before anything is graded."""

import tempfile
from pathlib import Path

from aro_robocop_goto_as.errors import GradingSetupError


def make_report_folder(folder: Path) -> Path:
    """Create the folder unless it exists; GradingSetupError if it can't be created or written to."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise GradingSetupError(f"the report can't be written to {folder}: {error.strerror}") from error
    return folder
