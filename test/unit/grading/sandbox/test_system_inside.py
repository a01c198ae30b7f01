"""What of the system a program in the sandbox finds."""

import subprocess
from pathlib import Path

import pytest

from robocop_grading.sandbox.bubblewrap import NAME

TIMEOUT = 600.0  # [s, wall]


@pytest.fixture
def inside(sandbox):
    """Makes the command line that runs a command in the sandbox."""
    environment = {"HOME": "/tmp/home", "PATH": "/usr/bin:/bin"}
    return lambda command: sandbox.session_command(sandbox.node_command(command, environment, (), Path("/tmp/home")))


def output(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=TIMEOUT)
    assert done.returncode == 0
    return done.stdout


def test_current_user_has_a_name_a_home_and_fonts(inside):
    code = (
        "import getpass, grp, os, pwd\nimport matplotlib.pyplot as plt\n"
        "user = pwd.getpwuid(os.getuid())\n"
        "group = grp.getgrgid(os.getgid()).gr_name\n"
        "print(getpass.getuser(), user.pw_name, user.pw_dir, group, os.path.expanduser('~'))\n"
        "plt.title('fonts')\nplt.savefig('figure.png')\n"
        "print(os.path.exists('figure.png'), os.listdir('/etc/fonts') != [])\n"
    )
    done = subprocess.run(inside(["/usr/bin/python3", "-c", code]), capture_output=True, text=True, timeout=TIMEOUT)
    assert done.stdout.splitlines() == [f"{NAME} {NAME} /tmp/home {NAME} /tmp/home", "True True"], done.stderr
    assert done.stderr in ("", "Matplotlib is building the font cache; this may take a moment.\n")  # after 5 s


def test_files_of_etc_that_not_everybody_may_read_are_hidden(inside):
    code = (
        "import os\n"
        "for folder, folders, files in os.walk('/etc'):\n"
        "    for path in (os.path.join(folder, name) for name in folders + files):\n"
        "        mode = 0 if os.path.islink(path) else os.stat(path).st_mode\n"
        "        if mode and not mode & 0o004 or '/shadow' in path or path == '/etc/ssl/private':\n"
        "            try:\n"
        "                print('SUCCESS', path, os.listdir(path) if os.path.isdir(path) else open(path).read())\n"
        "            except OSError:\n"
        "                print('refused', path)\n"
    )
    lines = output(inside(["/usr/bin/python3", "-c", code])).splitlines()
    assert "refused /etc/shadow" in lines
    assert not [line for line in lines if line.startswith("SUCCESS")]


def test_the_kernel_ends_what_is_inside_first_if_memory_runs_out(inside):
    code = (
        "file = '/proc/self/oom_score_adj'\nprint(open(file).read().strip())\n"
        "try:\n    open(file, 'w').write('0')\nexcept OSError:\n    print('refused')\n"
    )
    assert output(inside(["/usr/bin/python3", "-c", code])).splitlines() == ["1000", "refused"]
