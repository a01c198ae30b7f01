"""Where a command may write: what it did not make itself is never replaced, renamed or removed."""

import os
from pathlib import Path
from typing import Optional

from .errors import ParameterError


def expect_own(path: Path, stamp: str = "", source: Optional[Path] = None) -> None:
    """ParameterError unless a path is new, an empty folder, or a folder with the command's stamp, a file of this name.

    The path must not be `source`, which the command reads, nor be inside of it or around it.
    """
    if source is not None and (path == source or source in path.parents or path in source.parents):
        raise ParameterError(f"{path}: expected another folder than {source}, neither in it nor around it")
    try:
        if not os.path.lexists(path) or (stamp and (path / stamp).is_file()):
            return
        if not path.is_dir():
            raise ParameterError(f"{path} exists; give another name")
        if os.listdir(path):
            raise ParameterError(f"{path} has other files in it; give a new or an empty folder")
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror}") from error
