"""The script ./robocop: what it installs, refuses and shows before anything is installed."""

import fcntl
import os
import pty
import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command import ROOT, SETUP_TIMEOUT, environment, make_program, robocop
from fake_index import builds, source_release

from robocop_hosting.ports import free_port

pytestmark = pytest.mark.timeout(300)  # it builds workspaces

BUILD_INPUTS = ("CMakeLists.txt", "package.xml", "setup.py", "action", "cfg", "msg", "srv", "scripts", "src")


def test_shell_passes_arguments_and_exit_status_through():
    words = ("a b", "-0.5", "", "--help", "--extend")  # catkin's set-up files know the last two
    done = robocop("shell", "bash", "-c", 'rospack find aro_robocop_goto_as; printf "[%s]" "$@"; exit 7', "_", *words)
    found, words_passed = done.stdout.split("\n")
    assert (done.returncode, words_passed) == (7, "[a b][-0.5][][--help][--extend]")
    assert found.endswith("src/aro_robocop_goto_as"), done.stderr


def test_shell_completes_by_tab_and_knows_robocop_in_every_folder(tmp_path):
    keyboard, terminal = pty.openpty()
    os.write(keyboard, b"cd /; robocop version\nrosmsg show std_msgs/Floa\t32\nexit\n")
    command, settings = [str(ROOT / "robocop"), "shell"], environment(HOME=str(tmp_path), TERM="dumb")
    done = subprocess.run(command, env=settings, stdin=terminal, stderr=terminal, stdout=subprocess.PIPE, text=True)
    os.close(terminal)
    os.close(keyboard)
    assert done.stdout.startswith("aro_robocop_goto_as ") and done.stdout.endswith("float32 data\n\n")


@pytest.mark.parametrize("arguments", [("run",), ("clean",)])
def test_state_of_another_user_is_refused_with_the_remedy(checkout, arguments):
    root = checkout.rename(checkout.parent / "plain")
    (root / ".robocop").mkdir()
    by_root = os.geteuid() == 0
    if by_root:
        os.chown(root / ".robocop", 65534, 65534)
    else:
        (root / ".robocop").rmdir()
        (root / ".robocop").symlink_to("/usr")
    done = robocop(*arguments, root=root)
    remedy = "without sudo" if by_root else 'this makes it yours: sudo chown -R "$USER" '
    assert done.returncode == 1 and remedy in done.stderr and done.stderr.count("\n") == 1
    assert (root / ".robocop").exists()


def test_script_that_is_started_by_sh_runs_in_bash():
    done = subprocess.run(["sh", str(ROOT / "robocop"), "version"], stdout=subprocess.PIPE, text=True)
    assert done.stdout.startswith("aro_robocop_goto_as ")


@pytest.mark.parametrize(("word", "status"), [("no_such", 127), ("/etc/passwd", 126)])
def test_shell_tells_that_a_program_can_not_be_started(word, status):
    done = robocop("shell", word)
    assert done.returncode == status and word in done.stderr and done.stderr.count("\n") <= 2


def test_other_python_installations_are_ignored(tmp_path):
    for name in ("python", "python3", "pip", "cmake"):
        make_program(tmp_path / name, "#!/bin/sh\nexit 77\n")
    (tmp_path / "rospy.py").write_text("raise ImportError('not this one')\n")
    code = "import rospy, pybullet, aro_robocop_goto_as.msg; print('right')"
    nowhere = str(tmp_path / "nowhere")
    foreign = {"PYTHONHOME": nowhere, "VIRTUAL_ENV": nowhere, "CONDA_PREFIX": nowhere, "PYTHONPATH": str(tmp_path)}
    done = robocop("shell", "python3", "-c", code, PATH=f"{tmp_path}:{os.environ['PATH']}", **foreign)
    assert done.stdout == "right\n", done.stderr


def test_version_is_that_of_package_xml():
    wanted = ElementTree.parse(ROOT / "package.xml").findtext("version")
    assert robocop("version").stdout.split()[:2] == ["aro_robocop_goto_as", wanted]


@pytest.fixture
def checkout(tmp_path):
    """A copy of the checkout at a path with a space, that needs nothing from PyPI but pybullet's source release."""
    root = tmp_path / "check out"
    root.mkdir()
    for name in ("robocop", "install", *BUILD_INPUTS):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy2(ROOT / name, root / name)
    (root / "install" / "requirements.txt").write_text("pybullet==3.2.7\n")
    (root / "install" / "deb-packages" / "pybullet.txt").write_text("bash\n")
    (root / "scripts" / "robocop_goto.py").write_text("#!/usr/bin/env python3\nprint('started')\n")
    return root


@pytest.fixture
def index(tmp_path):
    """Settings for pip: an index that has a source release of pybullet and no wheel."""
    return source_release(tmp_path / "index")


def in_copy(root, *arguments, **settings):
    return robocop(*arguments, root=root, XDG_CACHE_HOME=str(root.parent / "cache"), **settings)


@pytest.fixture
def on_system(tmp_path):
    """A function: a dry run of a command on a machine where the content of some files is another one."""

    def dry_run_on(contents, *options, command=("setup",), **settings):
        binds = []
        for number, (path, content) in enumerate(contents.items()):
            make_program(tmp_path / str(number), content)
            binds += ["--ro-bind", str(tmp_path / str(number)), os.path.realpath(path)]
        command = ["bwrap", "--dev-bind", "/", "/", *binds, *options, str(ROOT / "robocop"), *command]
        settings = {"ROBOCOP_DRY_RUN": "1", **settings}
        return subprocess.run(command, env=environment(**settings), capture_output=True, text=True, timeout=60.0)

    return dry_run_on


FEDORA = {"/etc/os-release": 'ID=fedora\nVERSION_ID=41\nPRETTY_NAME="Fedora Linux 41"\n'}
MINT = {"/etc/os-release": 'ID=linuxmint\nID_LIKE="ubuntu debian"\nPRETTY_NAME="Linux Mint 22"\n'}


@pytest.mark.parametrize(
    "contents, reason",
    [
        (FEDORA, "Fedora Linux 41 has no packages of ROS 1; it needs Debian or Ubuntu, or ROS 1 in /opt/ros"),
        ({"/etc/os-release": ""}, "this system has no packages of ROS 1"),
        ({"/usr/bin/getconf": "#!/bin/sh\necho 32\n"}, "this is a 32-bit system; it needs a 64-bit one"),
    ],
)
def test_unsupported_system_is_refused_at_once_with_the_reason(on_system, contents, reason):
    done = on_system(contents)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"robocop: this system is not supported: {reason}")


@pytest.mark.parametrize("contents", [{}, MINT])
def test_supported_system_is_not_refused(on_system, contents):
    assert on_system(contents).returncode == 0


def usr_bin_without(names, tmp_path):
    """Options for bwrap: /usr/bin becomes a folder of links to the real one, which is mounted elsewhere."""
    real, links = tmp_path / "real", tmp_path / "links"
    for folder in (real, links):
        folder.mkdir()
    for entry in os.listdir("/usr/bin"):
        if entry not in names.split():
            (links / entry).symlink_to(real / entry)
    return ["--bind", "/usr/bin", str(real), "--bind", str(links), "/usr/bin"]


def test_any_distribution_will_do_where_ros_is_in_opt(on_system, tmp_path):
    ros = tmp_path / "noetic" / "bin"
    ros.mkdir(parents=True)
    make_program(ros / "roslaunch", "#!/bin/sh\n")
    mounts = usr_bin_without("roslaunch", tmp_path)
    without = on_system(FEDORA, *mounts)
    assert (without.returncode, "Fedora" in without.stderr) == (1, True)
    mounts += ["--tmpfs", "/opt", "--bind", str(tmp_path), "/opt/ros"]
    done = on_system(FEDORA, *mounts, PATH=f"/opt/ros/noetic/bin:{os.environ['PATH']}")
    assert done.returncode == 0, done.stderr


def test_doctor_shows_the_system_the_versions_and_that_nothing_is_missing():
    uri = f"http://localhost:{free_port()}"
    done = robocop("doctor", ROS_MASTER_URI=uri, DISPLAY=":4711")
    assert done.returncode == 0, done.stdout + done.stderr
    report = dict(line.split(maxsplit=1) for line in done.stdout.splitlines() if line)
    assert "Debian" in report["system"] and report["python"].endswith("(/usr/bin/python3)")
    assert [report[name][0].isdigit() for name in ("rospy", "numpy", "pybullet")] == [True, True, True]
    assert report["set-up"] == f"complete, in {ROOT}/.robocop"
    assert report["display"] == ":4711 does not answer"
    assert f"\nROS master  none at {uri}\n" in done.stdout
    assert done.stdout.endswith("\nnothing is missing: ./robocop run starts the lab\n")


def test_doctor_names_what_is_missing_with_the_command_and_installs_nothing(checkout):
    (checkout / "install" / "deb-packages" / "run.txt").write_text("bash\nno-such-package\n")
    done = in_copy(checkout, "doctor", ROS_MASTER_URI=f"http://localhost:{free_port()}")
    assert done.returncode == 1
    missing = done.stdout.partition("\nmissing or wrong:\n")[2]
    assert "apt-get install --no-install-recommends no-such-package\n" in missing
    assert "      ./robocop setup\n" in missing
    assert not (checkout / ".robocop").exists() and not (checkout.parent / "cache").exists()


@pytest.fixture
def without_python(on_system, tmp_path):
    """A function that calls ./robocop where there is no Python."""
    mounts = usr_bin_without(" ".join(path.name for path in Path("/usr/bin").glob("python3*")), tmp_path)
    return lambda *words: on_system({}, *mounts, command=words, PATH="/usr/bin:/bin", ROBOCOP_DRY_RUN="")


def test_help_of_every_command_is_printed_where_nothing_is_installed(without_python):
    text = without_python("help").stdout
    commands = set(re.findall(r"(?m)^  ([a-z][a-z-]*)", text))
    assert {"run", "goto", "grade", "grade-class", "new", "bench", "shell", "test"} < commands
    for command in commands:
        for words in ((command, "--help"), ("help", command)):
            done = without_python(*words)
            assert (done.returncode, done.stderr) == (0, "")
            assert done.stdout.startswith(f"  {command} ") and done.stdout in text


@pytest.mark.parametrize(
    "command, status, message",
    [
        ("doctor", 1, "nothing is installed yet, not even /usr/bin/python3; ./robocop setup does that\n"),
        ("tset", 2, "unknown command 'tset' (./robocop help lists them)\n"),
    ],
)
def test_without_python_nothing_is_installed_for_a_question(without_python, command, status, message):
    done = without_python(command)
    assert (done.returncode, done.stdout, done.stderr) == (status, "", f"robocop: {message}")


APT = '#!/bin/sh\necho "$@"\ntest "$1" = update\n'


def test_apt_shows_what_it_does_and_a_failure_is_told_with_what_to_run_as_root(checkout):
    root = checkout.rename(checkout.parent / "plain")
    (root / "install" / "deb-packages" / "run.txt").write_text("no-such-package\n")
    programs = root / ".robocop" / "venv" / "bin"
    programs.mkdir(parents=True)
    make_program(programs / "apt-get", APT)
    make_program(programs / "sudo", '#!/bin/sh\nexec "$@"\n')
    done = robocop("setup", root=root)
    assert (done.returncode, done.stdout) == (1, "")
    said = done.stderr.splitlines()
    assert said[0] == "robocop: installing Debian packages, which can take some minutes: no-such-package"
    assert said[1] == "update" and said[2].startswith("install -y ") and said[2].endswith(" no-such-package")
    assert said[3].endswith(f" As root, run: apt-get update && apt-get {said[2]}") and len(said) == 4


def test_what_is_complete_is_used_while_another_set_up_of_the_checkout_is_running():
    other = os.open(ROOT, os.O_RDONLY)
    try:
        fcntl.flock(other, fcntl.LOCK_EX)
        done = robocop("shell", "true")
    finally:
        os.close(other)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_call_in_another_locale_builds_nothing(tmp_path):
    command = ["localedef", "--quiet", "-i", "de_DE", "-f", "UTF-8", str(tmp_path / "de_DE.UTF-8")]
    subprocess.run(command, check=True, timeout=SETUP_TIMEOUT)  # that sorts as if file names had no underscores
    done = robocop("shell", "true", LC_ALL="de_DE.UTF-8", LOCPATH=str(tmp_path))
    assert (done.returncode, done.stderr) == (0, "")


CATKIN_MAKE = """#!/bin/sh
mkdir "$2/devel"
touch "$2/devel/setup.bash"
exit ${BUILD_STATUS:-0}
"""


@pytest.fixture
def quick(checkout):
    """A function that calls ./robocop in a checkout that lacks only the workspace; builds take no time."""
    root = checkout.rename(checkout.parent / "quick")
    (root / "install" / "deb-packages" / "run.txt").write_text("bash\n")
    programs = root / ".robocop" / "venv" / "bin"
    programs.mkdir(parents=True)
    for name, script in (("catkin_make", CATKIN_MAKE), ("python", "#!/bin/sh\n")):
        make_program(programs / name, script)
    (programs.parent / "made-as").write_text(f"{programs.parent} on {os.path.realpath('/usr/bin/python3')}")
    return lambda *arguments, **settings: robocop(*arguments, root=root, **settings)


def test_a_checkout_on_a_disk_without_locks_is_set_up_with_a_word_about_it(quick, tmp_path):
    source, library = tmp_path / "no_locks.c", tmp_path / "no_locks.so"
    source.write_text("#include <errno.h>\nint flock(int file, int operation) { errno = ENOLCK; return -1; }\n")
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", library, source], check=True, timeout=SETUP_TIMEOUT)
    done = quick("shell", "true", LD_PRELOAD=str(library))
    assert done.returncode == 0 and "robocop: building the workspace" in done.stderr, done.stderr
    assert "its disk has no locks: going on without" in done.stderr


@pytest.fixture
def user(quick, checkout):
    """A process that runs out of the first workspace of this checkout until its input ends."""
    script = str(checkout.parent / "quick" / "robocop")
    command = [script, "shell", "sh", "-c", "echo $ROBOCOP_WS; read line"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, env=environment(), text=True, **pipes) as process:
        process.workspace = Path(process.stdout.readline().strip()).parent
        yield process
        process.stdin.close()


def test_a_build_takes_the_workspace_away_from_nothing_that_runs(quick, user):
    state = user.workspace.parent
    action = state.parent / "action" / "Other.action"
    action.write_text("one")  # as a `git pull` does
    assert quick("shell", "true", BUILD_STATUS="1").returncode == 1
    assert (state / "workspace").resolve() == user.workspace, "a failed build leaves the old one in use"
    done = quick("shell", "printenv", "ROBOCOP_WS")
    assert done.stdout == f"{(state / 'workspace').resolve()}/devel\n" and user.workspace.is_dir(), done.stderr
    assert (state / "workspace").resolve() != user.workspace
    done = quick("clean")
    assert done.returncode == 1 and "clean would break what runs in this checkout: end it" in done.stderr

    user.communicate("")
    action.write_text("two")
    assert quick("shell", "true").returncode == 0
    assert list(state.glob("ws.*")) == [(state / "workspace").resolve()], "the last build removes what nobody uses"
    (state / "reports" / "lab").mkdir(parents=True)
    assert f"the reports of gradings stay in {state}\n" in quick("clean").stderr
    assert list(state.rglob("*")) == [state / "reports", state / "reports" / "lab"]
    shutil.rmtree(state / "reports")
    assert quick("clean").returncode == 0 and not state.exists()


def test_clean_waits_for_the_end_of_a_set_up(quick, checkout):
    root = checkout.parent / "quick"
    set_up = os.open(root, os.O_RDONLY)
    fcntl.flock(set_up, fcntl.LOCK_EX)
    command = [root / "robocop", "clean"]
    with subprocess.Popen(command, env=environment(), stderr=subprocess.PIPE, text=True) as clean:
        assert "waiting for another set-up" in clean.stderr.readline() and (root / ".robocop").exists()
        os.close(set_up)
    assert clean.returncode == 0 and not (root / ".robocop").exists()


def test_what_root_installs_and_builds_can_be_read_by_its_submissions_whatever_its_umask_is(quick, checkout):
    command = f"umask 077; exec {checkout.parent}/quick/robocop shell sh -c umask"
    done = subprocess.run(
        ["sh", "-c", command], env=environment(), capture_output=True, text=True, timeout=SETUP_TIMEOUT
    )
    assert done.stdout == ("0022\n" if os.geteuid() == 0 else "0077\n"), done.stderr


def test_run_is_no_obstacle_to_its_own_set_up(quick, checkout):
    root = checkout.parent / "quick"
    shutil.copytree(ROOT / "launch", root / "launch")
    (root / "install" / "deb-packages" / "web.txt").write_text("bash\n")
    for packages in ("one==1", "two==2"):
        (root / "install" / "requirements-web.txt").write_text(f"{packages}\n")
        done = quick("run", "web:=true", "rviz:=false", ROS_MASTER_URI=f"http://localhost:{free_port()}")
        assert (done.returncode, done.stderr.count("requirements-web.txt")) == (0, 1), done.stderr


def test_packages_are_not_replaced_below_what_uses_them(quick, user, checkout):
    root = user.workspace.parent.parent
    (root / "install" / "requirements.txt").write_text("another==1\n")
    done = quick("setup")
    assert done.returncode == 1
    assert "another version of Python packages would break what runs in this checkout: end it" in done.stderr
    user.communicate("")
    assert "installing the Python packages of requirements.txt" in quick("setup").stderr


@pytest.mark.slow
def test_pybullet_that_can_not_be_built_is_reported_with_the_end_of_the_log(checkout, index):
    done = in_copy(checkout, "setup", BUILD_FAILS="1", **index)
    assert done.returncode == 1
    announced = done.stderr.index("pip found no wheel of pybullet; building one")
    assert announced < done.stderr.index("takes about ") < done.stderr.index("error: no such thing")
    assert "robocop: pip failed. It needs a package index" in done.stderr


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_path_with_a_space_and_two_calls_at_once_then_another_action_then_moved(checkout, index):
    """One test, as each step needs the set-up of the one before, which takes seconds."""
    cache = checkout.parent / "cache"
    show = ("shell", "python3", "-c", "import aro_robocop_goto_as.msg as m; print(m.__file__)")
    calls = [
        subprocess.Popen(
            [str(checkout / "robocop"), *show],
            env=environment(XDG_CACHE_HOME=str(cache), CFLAGS="-O1", **index),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    answers = [(*call.communicate(timeout=SETUP_TIMEOUT), call.returncode) for call in calls]
    assert [status for _, _, status in answers] == [0, 0], answers
    assert builds(checkout.parent / "index") == ["-O1 -Wno-incompatible-pointer-types"]
    assert all(out.startswith(f"{cache}/robocop/") and " " not in out for out, _, _ in answers)
    assert not (checkout / ".robocop").exists()
    assert in_copy(checkout, "goto", "1", "2").stdout == "started\n"
    assert in_copy(checkout, "shell", "rosrun", "aro_robocop_goto_as", "robocop_goto.py").stdout == "started\n"

    (checkout / "action" / "Other.action").write_text("---\n---\n")
    rebuilt = in_copy(checkout, *show)
    assert (rebuilt.returncode, rebuilt.stderr) == (0, "robocop: building the workspace\n")
    assert rebuilt.stdout not in [out for out, _, _ in answers]
    assert in_copy(checkout, *show).stderr == ""  # nothing left to do

    moved = checkout.rename(checkout.parent / "moved")
    assert in_copy(moved, *show, **index).stdout.startswith(f"{moved}/.robocop/")
    assert in_copy(moved, "clean").returncode == 0
    assert not (moved / ".robocop").exists()
