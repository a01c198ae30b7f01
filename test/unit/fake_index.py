"""A package index whose only content is a source release of pybullet that is built in no time."""

import io
import tarfile

# A build backend without dependencies. Each build leaves a line in the file BUILDS: the flags for the compiler.
BACKEND = """
import os, zipfile
from pathlib import Path

def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with open(os.environ["BUILDS"], "a") as builds:
        builds.write(os.environ["CFLAGS"] + "\\n")
    if "BUILD_FAILS" in os.environ:
        raise SystemExit("caster.cpp:7: error: no such thing")
    name = "pybullet-3.2.7-py3-none-any.whl"
    info = "pybullet-3.2.7.dist-info/"
    with zipfile.ZipFile(Path(wheel_directory, name), "w") as archive:
        archive.writestr("pybullet.py", "")
        archive.writestr(info + "METADATA", "Metadata-Version: 2.1\\nName: pybullet\\nVersion: 3.2.7\\n")
        archive.writestr(info + "WHEEL", "Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n")
        archive.writestr(info + "RECORD", f"pybullet.py,,\\n{info}METADATA,,\\n{info}WHEEL,,\\n{info}RECORD,,\\n")
    return name
"""
PYPROJECT = '[build-system]\nrequires = []\nbuild-backend = "backend"\nbackend-path = ["."]\n'
METADATA = "Metadata-Version: 2.1\nName: pybullet\nVersion: 3.2.7\n"


def source_release(folder):
    """An index that has nothing but a source release of pybullet: what to set for pip."""
    folder.mkdir()
    with tarfile.open(folder / "pybullet-3.2.7.tar.gz", "w:gz") as archive:
        for name, text in (("backend.py", BACKEND), ("pyproject.toml", PYPROJECT), ("PKG-INFO", METADATA)):
            entry = tarfile.TarInfo(f"pybullet-3.2.7/{name}")
            entry.size = len(text.encode())
            archive.addfile(entry, io.BytesIO(text.encode()))
    return {
        "PIP_CONFIG_FILE": "/dev/null",
        "PIP_NO_INDEX": "1",
        "PIP_FIND_LINKS": str(folder),
        "BUILDS": str(folder / "builds"),
    }


def builds(folder):
    """The flags for the compiler, of each build."""
    path = folder / "builds"
    return path.read_text().splitlines() if path.exists() else []
