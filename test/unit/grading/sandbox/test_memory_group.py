"""A submission's control group: where there is none, and what the kernel's files say about one."""

import subprocess
from pathlib import Path

import pytest

from robocop_grading.sandbox import memory_group
from robocop_grading.sandbox.limits import MAX_SESSION_MEMORY

OURS = f"{MAX_SESSION_MEMORY}\n"


@pytest.fixture(name="group")
def _group(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the caller's group, as the kernel shows it."""
    own = tmp_path / "cgroup"
    own.write_text("0::/user.slice/run-1.scope\n")
    monkeypatch.setattr(memory_group, "OWN", own)
    monkeypatch.setattr(memory_group, "GROUPS", tmp_path)
    group = tmp_path / "user.slice" / "run-1.scope"
    group.mkdir(parents=True)
    return group


@pytest.mark.parametrize(
    "limit, reached, kills, blamed",
    [
        (OURS, 1, 1, True),
        (OURS, 1, 0, False),
        (OURS, 0, 1, False),  # killed as the machine lacked memory
        ("max\n", 0, 1, False),
        ("1073741824\n", 2, 2, False),
    ],
)
def test_only_the_limit_of_its_own_group_is_blamed_on_a_submission(
    group: Path, limit: str, reached: int, kills: int, blamed: bool
) -> None:
    (group / "memory.max").write_text(limit)
    (group / "memory.events").write_text(
        f"low 0\nhigh 0\nmax 1530\noom {reached}\noom_kill {kills}\noom_group_kill 0\n"
    )
    assert memory_group.reason() == ("its processes together took more than 3072 MB of memory" if blamed else "")


@pytest.mark.parametrize("text", ["9:name=systemd:/\n4:memory:/x\n", "0::/not/there\n", ""])
def test_without_a_group_nothing_is_blamed(group: Path, text: str) -> None:
    memory_group.OWN.write_text(text)
    assert memory_group.reason() == ""


def test_where_systemd_makes_no_group_commands_run_without_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    memory_group.prefix.cache_clear()
    assert memory_group.prefix() == ()
    memory_group.prefix.cache_clear()


def test_command_keeps_its_output_and_status() -> None:
    command = [*memory_group.prefix(), "/bin/sh", "-c", "echo text; exit 3"]  # with a group where this machine has one
    done = subprocess.run(command, capture_output=True, text=True, timeout=30.0)
    assert (done.stdout, done.returncode) == ("text\n", 3)
