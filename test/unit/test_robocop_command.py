"""The robocop command, as far as it can be tested without installing anything."""

import contextlib
import os
import shutil
import socket
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fake_index import builds, source_release

from aro_robocop_goto_as.process.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = (
    *("run", "goto", "test", "bench", "shell"),
    *("docs", "image", "completion", "doctor", "version", "setup", "clean", "help"),
)
LAUNCH = "/devel/lib/aro_robocop_goto_as/robocop_launch.py --quiet aro_robocop_goto_as"
BUILD_INPUTS = ("CMakeLists.txt", "package.xml", "setup.py", "action", "cfg", "msg", "srv", "scripts", "src")


def environment(**settings):
    """This test's environment without the variables that the command depends on, plus `settings`."""
    left_out = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "DISPLAY", "ROBOCOP_DRY_RUN", "ROBOCOP_WEB_HOST")
    chosen = {name: value for name, value in os.environ.items() if name not in left_out}
    chosen.update(settings)
    return chosen


def robocop(*arguments, root=ROOT, timeout=240.0, **settings):
    command = [str(root / "robocop"), *arguments]
    return subprocess.run(command, env=environment(**settings), capture_output=True, text=True, timeout=timeout)


def dry_run(*arguments, **settings):
    """The command that would be started, its ROS settings, and the messages."""
    done = robocop(*arguments, ROBOCOP_DRY_RUN="1", **settings)
    assert done.returncode == 0, done.stderr
    *settings, command = done.stdout.splitlines()
    return command.strip(), settings, done.stderr


def test_help_lists_every_command():
    done = robocop("help")
    assert done.returncode == 0
    for command in COMMANDS:
        assert f"\n  {command} " in done.stdout


def test_no_command_prints_the_help():
    assert robocop().stdout == robocop("help").stdout


def test_unknown_command_is_refused_with_its_name():
    done = robocop("tset")
    assert done.returncode == 2
    assert "tset" in done.stderr and "help" in done.stderr
    assert done.stdout == ""


def test_shell_passes_arguments_and_exit_status_through():
    done = robocop("shell", "bash", "-c", 'printf "[%s]" "$@"; exit 7', "_", "a b", "-0.5", "")
    assert (done.returncode, done.stdout) == (7, "[a b][-0.5][]")


def test_shell_finds_the_package():
    done = robocop("shell", "rosmsg", "show", "-r", "aro_robocop_goto_as/GoToPositionGoal")
    assert "geometry_msgs/Point position" in done.stdout, done.stderr


def test_other_python_installations_are_ignored(tmp_path):
    for name in ("python", "python3", "pip", "cmake"):
        (tmp_path / name).write_text("#!/bin/sh\nexit 77\n")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "rospy.py").write_text("raise ImportError('not this one')\n")
    code = "import rospy, pybullet, aro_robocop_goto_as.msg; print('right')"
    nowhere = str(tmp_path / "nowhere")
    foreign = {"PYTHONHOME": nowhere, "VIRTUAL_ENV": nowhere, "CONDA_PREFIX": nowhere, "PYTHONPATH": str(tmp_path)}
    done = robocop("shell", "python3", "-c", code, PATH=f"{tmp_path}:{os.environ['PATH']}", **foreign)
    assert done.stdout == "right\n", done.stderr


def test_ros_listens_on_loopback_by_default():
    assert dry_run("run")[1] == ["ROS_HOSTNAME=localhost"]


@pytest.mark.parametrize(
    "name, value", [("ROS_MASTER_URI", "http://robot:11311"), ("ROS_IP", "192.0.2.1"), ("ROS_HOSTNAME", "robot")]
)
def test_ros_network_setting_is_respected(name, value):
    assert dry_run("run", **{name: value})[1] == [f"{name}={value}"]


def test_without_a_display_the_web_page_is_started_instead_of_rviz_with_a_message():
    command, _, messages = dry_run("run", "world:=empty")
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch rviz:=false web:=true world:=empty")
    assert "no usable display; the web page is started instead of RViz" in messages


@pytest.mark.parametrize("chosen", ["true", "false"])
def test_without_a_display_the_web_page_is_left_as_chosen(chosen):
    command, _, messages = dry_run("run", f"web:={chosen}")
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch rviz:=false web:={chosen}")
    assert "no usable display; RViz is not started\n" in messages


@pytest.mark.slow
def test_without_a_display_the_lab_starts_even_if_the_web_page_can_not_be_installed(checkout, index):
    (checkout / "requirements-web.txt").write_text("robocop-has-no-such-package==1\n")
    shutil.copytree(ROOT / "launch", checkout / "launch")
    (checkout / "scripts" / "robocop_launch.py").write_text("#!/usr/bin/env python3\nimport sys; print(sys.argv[1:])\n")
    uri = f"http://localhost:{free_port()}"
    done = in_copy(checkout, "run", "world:=empty", ROS_MASTER_URI=uri, **index)
    assert (done.returncode, "'rviz:=false', 'world:=empty']" in done.stdout) == (0, True), done.stdout + done.stderr
    assert "RViz is not started, and the web page could not be installed" in done.stderr


def test_web_starts_the_page_with_its_arguments():
    assert dry_run("web", "web_port:=8090")[0].endswith("/robocop_web.py web_port:=8090")


def test_set_up_of_an_unknown_part_is_refused_with_the_known_ones():
    done = robocop("setup", "wbe")
    assert done.returncode == 1
    assert "no part 'wbe'; there are: class docs grade " in done.stderr


def test_unreachable_display_counts_as_none():
    assert "rviz:=false" in dry_run("run", DISPLAY=":4711")[0]


@contextlib.contextmanager
def x_server():
    """A working X server; yields its DISPLAY."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "320x240x24"], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    try:
        os.close(write)
        with open(read) as display:
            yield f":{display.readline().strip()}"
    finally:
        server.terminate()
        server.wait()


def test_rviz_is_opened_on_a_working_display():
    with x_server() as display:
        assert "rviz:=true" in dry_run("run", DISPLAY=display)[0]


def test_a_watched_grading_sets_up_rviz_on_a_working_display_and_else_the_page():
    with x_server() as display:
        assert "would set up: run hosting grade rviz\n" in dry_run("grade", "x.py", "--watch", DISPLAY=display)[2]
    for unusable in ({"DISPLAY": ":4711"}, {"DISPLAY": "localhost:10.0"}, {}):  # ssh -X: not from inside the sandbox
        assert "would set up: run hosting grade web\n" in dry_run("grade", "x.py", "--watch", **unusable)[2]
    assert "would set up: run hosting grade\n" in dry_run("grade", "x.py")[2]


@pytest.mark.parametrize("argument", ["rviz:=true", "rviz:=false"])
def test_explicit_rviz_argument_overrides_the_display_check(argument):
    command = dry_run("run", argument)[0]
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch {argument}")


@pytest.mark.parametrize("command, file", [("run", "robocop_goto_as.launch"), ("sim", "robocop_sim.launch")])
def test_run_and_sim_start_the_launcher_that_reports_the_simulators_exit_status(command, file):
    unused_uri = f"http://localhost:{free_port()}"
    assert f"{LAUNCH} {file}" in dry_run(command, "world:=empty", ROS_MASTER_URI=unused_uri)[0]


@pytest.mark.parametrize("command", ["run", "sim"])
def test_verbose_shows_the_messages_of_all_nodes(command):
    started = dry_run(command, "--verbose", "world:=empty", ROS_MASTER_URI=f"http://localhost:{free_port()}")[0]
    assert LAUNCH.replace("--quiet ", "") in started and started.endswith(" world:=empty")


@pytest.mark.parametrize("command", ["run", "sim"])
def test_paths_of_files_are_made_absolute_as_the_nodes_run_in_another_folder(command, tmp_path, monkeypatch):
    (tmp_path / "my.sdf").write_text("<sdf/>")
    monkeypatch.chdir(tmp_path)
    assert f" world:={tmp_path}/my.sdf" in dry_run(command, "world:=my.sdf")[0]
    assert " world:=stage_1.5" in dry_run(command, "world:=stage_1.5")[0]


@pytest.mark.parametrize("word", ["world=stage_1", "stage_1"])
def test_a_word_that_is_no_launch_argument_is_refused_with_an_example(word):
    done = robocop("run", word, ROBOCOP_DRY_RUN="1")
    assert done.returncode == 1
    assert f"expected NAME:=VALUE, such as world:=stage_1; got '{word}'" in done.stderr


@pytest.mark.parametrize("command", ["run", "sim"])
def test_unknown_launch_argument_is_refused_with_the_known_ones(command):
    done = robocop(command, "wrld:=empty", ROBOCOP_DRY_RUN="1")
    assert done.returncode == 1
    assert "there is no argument wrld; there are: " in done.stderr and " world " in done.stderr


@pytest.mark.parametrize(
    "command",
    [
        ("run", "rviz:=false"),
        pytest.param(("sim",), marks=pytest.mark.slow),
        pytest.param(("goto", "1", "0"), marks=pytest.mark.slow),
    ],
)
def test_port_that_never_answers_is_reported_within_seconds(command):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        uri = f"http://127.0.0.1:{silent.getsockname()[1]}"
        done = robocop(*command, ROS_MASTER_URI=uri, timeout=60.0)
    assert (done.returncode, done.stdout) == (1, "")
    assert f"{uri} did not answer within 5 s: stop the process that uses this port" in done.stderr


def test_version_is_that_of_package_xml():
    wanted = ElementTree.parse(ROOT / "package.xml").findtext("version")
    assert robocop("version").stdout.split()[:2] == ["aro_robocop_goto_as", wanted]


def test_goto_passes_negative_numbers():
    assert dry_run("goto", "-0.5", "-1", "--frame", "map")[0].endswith("/robocop_goto.py -0.5 -1 --frame map")


@pytest.fixture
def checkout(tmp_path):
    """A copy of the checkout at a path with a space, that needs nothing from PyPI but pybullet's source release."""
    root = tmp_path / "check out"
    root.mkdir()
    for name in ("robocop", "deb-packages", *BUILD_INPUTS):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy2(ROOT / name, root / name)
    (root / "requirements.txt").write_text("pybullet==3.2.7\n")
    (root / "deb-packages" / "pybullet.txt").write_text("bash\n")
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

    def dry_run_on(contents, *options, command="setup", **settings):
        binds = []
        for number, (path, content) in enumerate(contents.items()):
            fake = tmp_path / str(number)
            fake.write_text(content)
            fake.chmod(0o755)
            binds += ["--ro-bind", str(fake), os.path.realpath(path)]
        command = ["bwrap", "--dev-bind", "/", "/", *binds, *options, str(ROOT / "robocop"), command]
        return subprocess.run(
            command, env=environment(ROBOCOP_DRY_RUN="1", **settings), capture_output=True, text=True, timeout=60.0
        )

    return dry_run_on


FEDORA = {"/etc/os-release": 'ID=fedora\nVERSION_ID=41\nPRETTY_NAME="Fedora Linux 41"\n'}
MINT = {"/etc/os-release": 'ID=linuxmint\nID_LIKE="ubuntu debian"\nPRETTY_NAME="Linux Mint 22"\n'}


@pytest.mark.parametrize(
    "contents, reason",
    [
        (FEDORA, "Fedora Linux 41 has no packages of ROS 1; it needs Debian or Ubuntu, or ROS 1 in /opt/ros"),
        ({"/etc/os-release": ""}, "this Linux has no packages of ROS 1"),
        ({"/usr/bin/getconf": "#!/bin/sh\necho 32\n"}, "this is a 32-bit system; it needs a 64-bit one"),
        ({"/usr/bin/python3": "#!/bin/sh\necho 3.7\n"}, "/usr/bin/python3 is Python 3.7; it needs 3.8"),
        ({"/usr/bin/uname": "#!/bin/sh\necho FreeBSD\n"}, "this is FreeBSD; it needs Linux"),
    ],
)
def test_unsupported_system_is_refused_at_once_with_the_reason(on_system, contents, reason):
    done = on_system(contents)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"robocop: this system is not supported: {reason}")


@pytest.mark.parametrize("contents", [{}, MINT, {"/usr/bin/python3": "#!/bin/sh\necho 3.13\n"}])
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
    (ros / "roslaunch").write_text("#!/bin/sh\n")
    (ros / "roslaunch").chmod(0o755)
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
    assert done.stdout.endswith("\nnothing is missing\n")


def test_doctor_names_what_is_missing_with_the_command_and_installs_nothing(checkout):
    (checkout / "deb-packages" / "run.txt").write_text("bash\nno-such-package\n")
    with socket.create_server(("127.0.0.1", 0)) as silent:
        uri = f"http://127.0.0.1:{silent.getsockname()[1]}"
        done = in_copy(checkout, "doctor", ROS_MASTER_URI=uri)
    assert done.returncode == 1
    missing = done.stdout.partition("\nmissing or wrong:\n")[2]
    assert "apt-get install --no-install-recommends no-such-package\n" in missing
    assert "      ./robocop setup\n" in missing
    assert f"{uri} did not answer within 5 s" in missing
    assert not (checkout / ".robocop").exists() and not (checkout.parent / "cache").exists()


def test_doctor_says_why_a_system_is_not_supported(on_system):
    done = on_system(FEDORA, command="doctor")
    assert done.returncode == 1
    assert "this system is not supported\n      Fedora Linux 41 has no packages of ROS 1; " in done.stdout


ENGINES = "docker podman buildah"


def image(on_system, tmp_path, engines):
    """Outcome of `./robocop image` in a dry run, where /usr/bin has these engines: name -> script."""
    mounts = usr_bin_without(ENGINES, tmp_path)
    for name, script in engines.items():
        (tmp_path / "links" / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / "links" / name).chmod(0o755)
    return on_system({}, *mounts, command="image", PATH="/usr/bin:/bin")


ANSWERS, FAILS = "exit 0", "echo no daemon >&2; exit 1"


@pytest.mark.parametrize(
    "engines, chosen",
    [
        ({"docker": ANSWERS, "podman": ANSWERS}, "docker"),
        ({"docker": FAILS, "podman": ANSWERS, "buildah": ANSWERS}, "podman"),
        ({"buildah": ANSWERS}, "buildah"),
    ],
)
def test_image_is_built_by_the_first_engine_that_answers(on_system, tmp_path, engines, chosen):
    done = image(on_system, tmp_path, engines)
    assert done.stdout.startswith(f"{chosen} build --tag robocop --label "), done.stderr
    assert done.stdout.split()[-1] == str(ROOT)


@pytest.mark.parametrize(
    "engines, reason",
    [
        ({}, "image: this needs docker, podman or buildah; on Debian and Ubuntu: apt-get install podman"),
        ({"docker": FAILS}, "image: docker is installed, but it does not answer: no daemon"),
    ],
)
def test_image_without_an_engine_is_refused_with_what_to_do(on_system, tmp_path, engines, reason):
    done = image(on_system, tmp_path, engines)
    assert (done.returncode, done.stdout, done.stderr) == (1, "", f"robocop: {reason}\n")


def test_doctor_works_without_python(on_system, tmp_path):
    done = on_system({}, *usr_bin_without("python3", tmp_path), command="doctor")
    assert done.returncode == 1
    assert "nothing is installed yet, not even /usr/bin/python3" in done.stderr


def test_up_to_date_set_up_installs_nothing_and_adds_less_than_a_second(tmp_path):
    """A second of processor time: wall time would depend on what else the machine does."""
    assert robocop("setup").returncode == 0
    with open(tmp_path / "errors", "w+") as errors:
        command = subprocess.Popen([str(ROOT / "robocop"), "shell", "true"], env=environment(), stderr=errors)
        _, status, usage = os.wait4(command.pid, 0)
        command.returncode = status
        errors.seek(0)
        assert (status, errors.read()) == (0, ""), "a step of the setup was repeated"
    assert usage.ru_utime + usage.ru_stime < 1.0


def test_missing_debian_package_is_named_with_the_line_to_type(checkout):
    (checkout / "deb-packages" / "run.txt").write_text("# comment\nbash\nno-such-package # comment\n")
    done = robocop("setup", root=checkout, ROBOCOP_DRY_RUN="1")
    assert "apt-get install --no-install-recommends no-such-package\n" in done.stderr


@pytest.mark.slow
def test_pybullet_that_can_not_be_built_is_reported_with_the_end_of_the_log(checkout, index):
    done = in_copy(checkout, "setup", BUILD_FAILS="1", **index)
    assert done.returncode == 1
    announced = done.stderr.index("PyPI has no wheel of pybullet==3.2.7 for Python 3.")
    assert announced < done.stderr.index("this takes about ") < done.stderr.index("error: no such thing")
    assert "robocop: pybullet==3.2.7 could not be built from its source release (full log: " in done.stderr


@pytest.mark.slow
def test_index_without_pybullet_is_reported_and_nothing_is_built(checkout, index):
    done = in_copy(checkout, "setup", **{**index, "PIP_FIND_LINKS": str(checkout)})
    assert done.returncode == 1
    assert "pip failed. It needs a package index that provides pybullet==3.2.7 (full log: " in done.stderr
    assert "source release" not in done.stderr


@pytest.mark.slow
def test_path_with_a_space_and_two_calls_at_once_then_broken_then_moved(checkout, index):
    """One test, as each step needs the set-up of the one before, which takes seconds."""
    cache = checkout.parent / "cache"
    show = ("shell", "python3", "-c", "import aro_robocop_goto_as.msg as m; print(m.__file__)")
    calls = [
        subprocess.Popen(
            [str(checkout / "robocop"), *show],
            env=environment(XDG_CACHE_HOME=str(cache), **index),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    answers = [(*call.communicate(timeout=240), call.returncode) for call in calls]
    assert [status for _, _, status in answers] == [0, 0], answers
    assert len(builds(checkout.parent / "index")) == 1
    assert [path.name for path in cache.glob("robocop/wheels/*.whl")] == ["pybullet-3.2.7-py3-none-any.whl"]
    assert all(out.startswith(f"{cache}/robocop/") and " " not in out for out, _, _ in answers)
    assert not (checkout / ".robocop").exists()
    assert in_copy(checkout, "goto", "1", "2").stdout == "started\n"
    assert in_copy(checkout, "shell", "rosrun", "aro_robocop_goto_as", "robocop_goto.py").stdout == "started\n"

    # An interrupted build of a changed action leaves half a workspace and no stamp.
    shutil.rmtree(next(cache.glob("robocop/*/ws/devel")))
    (checkout / "action" / "Other.action").write_text("---\n---\n")
    assert in_copy(checkout, *show).returncode == 0
    assert in_copy(checkout, *show).stderr == ""  # nothing left to do

    moved = checkout.rename(checkout.parent / "moved")
    assert in_copy(moved, *show, **index).stdout.startswith(f"{moved}/.robocop/")
    assert len(builds(checkout.parent / "index")) == 1  # the new set-up has found the wheel
    assert in_copy(moved, "clean").returncode == 0
    assert not (moved / ".robocop").exists()
