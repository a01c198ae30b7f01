"""./robocop image: builds the container image."""

import shutil
import subprocess
from typing import List, NoReturn

from .program import ROOT, become, refuse, version


def build(arguments: List[str]) -> NoReturn:
    """Become the program that builds the image. Arguments: the image's name, if any, and options of that program."""
    named = bool(arguments) and not arguments[0].startswith("-")
    name, options = (arguments[0], arguments[1:]) if named else ("robocop", arguments)
    engine = _engine()
    label = f"org.opencontainers.image.version={version()}"
    become(engine, "build", "--tag", name, "--label", label, *options, str(ROOT))


def _engine() -> str:
    """The program that builds container images: docker if its daemon answers, else podman or buildah."""
    problem = ""
    if shutil.which("docker"):
        answer = subprocess.run(["docker", "version"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if answer.returncode == 0:
            return "docker"
        problem = (answer.stderr.splitlines() or [""])[0]
    for engine in ("podman", "buildah"):
        if shutil.which(engine):
            return engine
    if problem:
        refuse(f"image: docker is installed, but it does not answer: {problem}")
    refuse("image: this needs docker, podman or buildah; on Debian and Ubuntu: apt-get install podman")
