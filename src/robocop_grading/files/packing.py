"""Packs a hand-in into one tar archive, for the sandbox: nothing in it is looked at."""

import hashlib
import signal
import subprocess
from pathlib import Path
from typing import Sequence

from robocop_hosting import tree

from ..errors import GradingError
from ..sandbox.limits import MAX_HAND_IN, MB

KINDS = "avi bag heic m4v mkv mov mp4 mpeg mpg ogv pdf webm wmv".split()  # videos, recordings, documents
MADE = (*tree.GENERATED, ".git", ".robocop", ".ipynb_checkpoints", ".DS_Store")
# Patterns; ._* are the files in which macOS keeps attributes of others.
LEFT_OUT = (*MADE, "._*", *(f"*.{kind}" for it in KINDS for kind in (it, it.upper())))
# The same content makes the same archive. Readable by everybody, whatever the umask was.
REPRODUCIBLE = "--sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=a+rX,u+w".split()
WITHOUT_MOODLE = r"s,^\./[^/]*_assignsubmission_[a-z]+_?,./,xS"  # what it puts before the name of a file
CHANGED_MEANWHILE = 1  # exit status of tar


def pack(entries: Sequence[Path], archive: Path) -> str:
    """Write files and folders that lie beside one another to a tar archive; return a digest of their content.

    GradingError if they can't be read, or are too large.
    """
    tar = ["tar", "--create", f"--file={archive}", *REPRODUCIBLE, f"--transform={WITHOUT_MOODLE}"]
    tar += [*(f"--exclude={it}" for it in LEFT_OUT), f"--directory={entries[0].parent}"]
    limited = ["prlimit", f"--fsize={MAX_HAND_IN}", "--", *tar, "--", *(f"./{it.name}" for it in entries)]
    done = subprocess.run(limited, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
    if done.returncode == -signal.SIGXFSZ:
        raise GradingError(f"larger than {MAX_HAND_IN // MB} MB, without build products, videos and recordings")
    if done.returncode not in (0, CHANGED_MEANWHILE):
        told = done.stderr.decode(errors="replace").splitlines()
        raise GradingError(f"can't be read: {told[0] if told else f'tar ended with {done.returncode}'}")
    with open(archive, "rb") as file:
        digest = hashlib.sha256()
        for part in iter(lambda: file.read(MB), b""):
            digest.update(part)
    return digest.hexdigest()
