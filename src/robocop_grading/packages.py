"""Packages that a plan names because the lab has them: Debian's have to be installed, PyPI's are installed once."""

import os
import re
import shutil
import subprocess
import sys
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Tuple

from aro_robocop_goto_as.param_loading import several
from robocop_hosting.workspace import exclusive

from .errors import UngradableError

# With a version, as pip takes it, and not an option of pip or dpkg.
PACKAGE_NAME = re.compile(r"[A-Za-z0-9][\w.+\-]*(\[[\w,]+\])?([=<>!~]=[\w.*+]+)?", re.ASCII)


@dataclass(frozen=True)
class Packages:
    """Names of packages."""

    debian: Tuple[str, ...] = several()
    pypi: Tuple[str, ...] = several()  # without their dependencies, which could replace Debian's, such as NumPy

    def conflicts(self) -> List[str]:
        """The names that are no package names, in words."""
        names = (*self.debian, *self.pypi)
        return [f"expected the name of a package, got {it!r}" for it in names if not PACKAGE_NAME.fullmatch(it)]


def provide(packages: Packages, state: Path) -> Optional[Path]:
    """The folder with the packages of PyPI, if there are any. UngradableError if a package can't be had."""
    missing = [name for name in packages.debian if not _is_installed(name)]
    if missing:
        raise UngradableError(f"the plan's packages are not installed: sudo apt-get install {' '.join(missing)}")
    if not packages.pypi:
        return None
    version = "python{}.{}".format(*sys.version_info)
    folder = state / "packages" / f"{zlib.crc32(repr((version, packages.pypi)).encode()):08x}"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with exclusive(folder):
        if not folder.is_dir():
            _install(packages.pypi, folder)
    return folder


def _is_installed(name: str) -> bool:
    query = ["dpkg-query", "--show", "--showformat=${db:Status-Status}", name]
    return subprocess.run(query, capture_output=True, text=True).stdout == "installed"


def _install(names: Tuple[str, ...], folder: Path) -> None:
    part = folder.with_name(f"{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-input", "--no-deps", "--target", str(part), *names]
    done = subprocess.run(pip, capture_output=True, text=True)
    if done.returncode != 0:
        reason = " | ".join(done.stderr.strip().splitlines()[-2:])
        raise UngradableError(f"the plan's packages can't be installed: {reason}")
    os.rename(part, folder)
