"""What of the system a program in the sandbox finds; without a sandbox nothing is graded."""

import contextlib
import os

import pytest

from robocop_grading.errors import GradingSetupError
from robocop_grading.sandbox.bubblewrap import NAME, open_sandbox


def test_current_user_has_a_name_a_home_and_fonts(printed):
    code = """
    import getpass, grp, os, pwd
    import matplotlib.pyplot as plt
    user, group = pwd.getpwuid(os.getuid()), grp.getgrgid(os.getgid()).gr_name
    plt.title("fonts")
    plt.savefig("figure.png")
    print(getpass.getuser(), user.pw_name, user.pw_dir, group, os.path.expanduser("~"), os.listdir("/etc/fonts") != [])
    """
    lines = [line for line in printed(code) if "font cache" not in line]  # told after 5 s
    assert lines == [f"{NAME} {NAME} /tmp/home {NAME} /tmp/home True"]


def test_files_of_etc_that_not_everybody_may_read_are_hidden(printed):
    code = """
    import os
    for folder, folders, files in os.walk("/etc"):
        for path in (os.path.join(folder, name) for name in folders + files):
            mode = 0 if os.path.islink(path) else os.stat(path).st_mode
            if mode and not mode & 0o004 or "/shadow" in path or path == "/etc/ssl/private":
                try:
                    print("SUCCESS", path, os.listdir(path) if os.path.isdir(path) else open(path).read())
                except OSError:
                    print("refused", path)
    """
    lines = printed(code)
    assert "refused /etc/shadow" in lines
    assert not [line for line in lines if not line.startswith("refused ")]


def test_the_kernel_ends_what_is_inside_first_if_memory_runs_out(printed):
    code = """
    file = "/proc/self/oom_score_adj"
    print(open(file).read().strip())
    try:
        open(file, "w").write("0")
    except OSError:
        print("refused")
    """
    assert printed(code) == ["1000", "refused"]


def test_nothing_is_graded_if_the_user_of_submissions_can_not_read_what_they_need(tmp_path):
    (tmp_path / "installed").mkdir(mode=0o700)
    refused = pytest.raises(GradingSetupError, match=f"^{tmp_path}/installed: .* who can't read it: chmod -R go\\+rX ")
    with refused if os.geteuid() == 0 else contextlib.nullcontext():  # others' submissions run as themselves
        open_sandbox(False, [tmp_path / "installed"])


@pytest.mark.parametrize("missing", ["bubblewrap", "python3-seccomp"])
def test_sandbox_that_is_not_installed_is_an_error_of_the_set_up(missing, tmp_path, monkeypatch):
    if missing == "bubblewrap":
        monkeypatch.setenv("PATH", str(tmp_path))
    else:
        monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(GradingSetupError, match=f"{missing} is not installed; --unsafe runs the submission without it"):
        open_sandbox(False)
    assert open_sandbox(True) is None
