"""Hosted packages: found at a path."""

import os

import pytest
from hosted_packages import LAB, MANIFEST, tree

from robocop_hosting.errors import HostingError
from robocop_hosting.package import find_package, read_launch_plan


def test_package_is_found_from_its_folder_or_its_workspace(tmp_path):
    tree(tmp_path, {f"src/{name}/package.xml": MANIFEST.format(name) for name in (LAB, "tools")})
    tree(tmp_path, {f"src/{LAB}/scripts/robocop_goto_as.py": "", "build/x/package.xml": "<package/>"})
    for path in ("", "src", f"src/{LAB}"):
        package = find_package(str(tmp_path / path))
        assert (package.name, package.path) == (LAB, tmp_path / "src" / LAB)


WORKSPACE = {
    LAB: "<exec_depend>maths</exec_depend><depend>aro_sim</depend>",
    "maths": "<depend>units</depend>",
    "units": "",
    "other": "",
}


def workspace(top):
    """The lab's package beside others, among them ones that are not to be built, in the folder src of a workspace."""
    for name, lines in {
        **WORKSPACE,
        "aro_sim": "",
        "ignored": "",
        "two": "<build_type>ament_cmake</build_type>",
    }.items():
        tree(top, {f"src/{name}/package.xml": MANIFEST.format(name).replace("</package>", f"{lines}</package>")})
    return tree(top, {"src/ignored/CATKIN_IGNORE": "", f"src/{LAB}/scripts/robocop_goto_as.py": ""})


def test_of_packages_beside_it_those_are_graded_with_it_on_which_it_depends(tmp_path):
    package = find_package(str(workspace(tmp_path)))
    assert package.sources == {name: tmp_path / "src" / name for name in (LAB, "maths", "units")}
    assert list(find_package(str(tmp_path / "src" / LAB)).sources) == [LAB], "nothing outside of the hand-in"


@pytest.mark.parametrize("path", ["", f"src/{LAB}"])
def test_package_is_run_with_its_whole_workspace_but_for_what_is_here_already(tmp_path, path):
    package = find_package(str(workspace(tmp_path) / path), grades=False)
    assert package.sources == {name: tmp_path / "src" / name for name in WORKSPACE}


@pytest.mark.parametrize("name", ["lab_drive", "aro_sim"])
def test_only_package_is_taken_whatever_its_name_is(tmp_path, name):
    tree(tmp_path, {"src/it/package.xml": MANIFEST.format(name), "src/it/x.launch": "<launch/>"})
    assert find_package(str(tmp_path), grades=False).sources == {name: tmp_path / "src" / "it"}


def test_script_is_guessed_beside_several_launch_files_only_to_be_graded(tmp_path):
    files = {f"launch/{name}.launch": "<launch/>" for name in "ab"}
    tree(tmp_path, {**files, "package.xml": MANIFEST.format("lab"), "scripts/watch.py": "'move_base_simple'"})
    assert find_package(str(tmp_path)).launch_file is None
    with pytest.raises(HostingError, match="several launch files: add --launch NAME, of a.launch, b.launch"):
        find_package(str(tmp_path), grades=False)


@pytest.mark.parametrize(
    "files, launch, expected",
    [
        ({"a/x.launch": "", "b/msg/A.msg": ""}, "", "a"),
        ({"a/x.launch": "", "a/y.launch": "", "b/scripts/robocop_goto_as.py": ""}, "", "b"),
        ({"a/x.launch": "", "b/y.launch": ""}, "y.launch", "b"),
        ({f"{LAB}/robocop_goto_as.launch": "", "b/y.launch": ""}, "y.launch", "b"),
        ({f"{LAB}/robocop_goto_as.launch": "", "b/y.launch": ""}, "", LAB),
    ],
)
def test_of_several_packages_the_only_one_that_has_what_is_asked_for_is_taken(tmp_path, files, launch, expected):
    names = {file.partition("/")[0] for file in files}
    tree(tmp_path, {**files, **{f"{name}/package.xml": MANIFEST.format(name) for name in names}})
    assert find_package(str(tmp_path), launch).name == expected


@pytest.mark.parametrize(
    "files, expected",
    [
        ({}, "no package.xml in it or below it"),
        ({"package.xml": "<package>"}, "package.xml: not XML that can be read: no element found"),
        ({"package.xml": "<package/>"}, "package.xml: expected a <name>"),
        (
            {
                "a/package.xml": MANIFEST.format("a"),
                "b/package.xml": MANIFEST.format("b"),
                "b/x.launch": "",
                "a/y.launch": "",
            },
            r"2 packages found, give the path of one: /.*/a \(a: y.launch\), /.*/b \(b: x.launch\)",
        ),
        (
            {"package.xml": MANIFEST.format("p"), "b.launch": "<launch/>", "launch/a.launch": "<launch/>"},
            "no Python script, and launch files: a.launch, b.launch",
        ),
        ({"package.xml": MANIFEST.format(LAB)}, "nothing to start: expected launch/robocop_goto_as.launch, or scripts"),
        ({"package.xml": MANIFEST.format(LAB), "src/move.py": "print(1)"}, "action server; found: src/move.py"),
        (
            {"package.xml": MANIFEST.format("p").replace("</p", "<build_type>ament_python</build_type></p")},
            r"package.xml: this is a package of ROS 2 \(build type ament_python\), and here is ROS 1: use its branch",
        ),
        ({"package.xml": MANIFEST.format("../../up")}, "expected a <name> of letters, digits, _ and -, got '../../up'"),
        (
            {
                "package.xml": MANIFEST.format(LAB),
                "a/robocop_goto_as.launch": "<launch/>",
                "b/robocop_goto_as.launch": "<launch></launch>",
            },
            "a/robocop_goto_as.launch and b/robocop_goto_as.launch: nothing says which",
        ),
    ],
)
def test_folder_without_a_package_to_start_is_refused(tmp_path, files, expected):
    with pytest.raises(HostingError, match=expected):
        find_package(str(tree(tmp_path, files)))


def test_missing_path_is_refused():
    with pytest.raises(HostingError, match="/no/such/place: expected the folder of a catkin package"):
        find_package("/no/such/place")


PAIR = {"package.xml": MANIFEST.format(LAB), "a.launch": "<launch><arg name='speed'/></launch>"}


def test_launch_file_is_the_named_one_else_the_labs_else_the_only_one(tmp_path):
    tree(tmp_path, PAIR)
    assert find_package(str(tmp_path)).launch_file == tmp_path / "a.launch"
    tree(tmp_path, {"launch/robocop_goto_as.launch": "<launch/>"})
    assert find_package(str(tmp_path)).launch_file == tmp_path / "launch" / "robocop_goto_as.launch"
    assert find_package(str(tmp_path), "a.launch").launch_file == tmp_path / "a.launch"
    with pytest.raises(HostingError, match="no launch file 'b.launch'; available: a.launch, robocop_goto_as.launch"):
        find_package(str(tmp_path), "b.launch")


@pytest.mark.parametrize("folder", ["backup", "OLD", "lab - Copy", "__MACOSX", ".ipynb_checkpoints"])
def test_copies_aside_are_neither_the_package_nor_its_launch_file(tmp_path, folder):
    lab = {"package.xml": MANIFEST.format(LAB), "launch/robocop_goto_as.launch": "<launch/>"}
    other = {f"{folder}/{name}": text.replace("/>", "></launch>") for name, text in lab.items()}
    beside = tree(tmp_path / "beside", {**{f"my_lab/{name}": text for name, text in lab.items()}, **other})
    inside = tree(tmp_path / "inside", {**lab, f"{folder}/launch/robocop_goto_as.launch": "<launch></launch>"})
    assert find_package(str(beside)).path == beside / "my_lab"
    assert find_package(str(inside)).launch_file == inside / "launch" / "robocop_goto_as.launch"


def test_what_a_launch_file_asks_for_in_vain_is_named(tmp_path):
    node = '<node pkg="{}" type="{}" name="n{}"/>\n'
    nodes = [
        (LAB, "robocop_goto_as.py"),
        (LAB, "none.py"),
        ("tf2_ros", "static"),
        ("rviz", "rviz"),
        ("other", "goto.py"),
    ]
    launch = "".join(node.format(*names, number) for number, names in enumerate(nodes))
    files = {
        "package.xml": MANIFEST.format(LAB),
        "launch/robocop_goto_as.launch": f"<launch>{launch}</launch>",
        "scripts/robocop_goto_as.py": "",
        "scripts/goto.py": "move_base_simple",
    }
    package = find_package(str(tree(tmp_path / "ws" / "src" / LAB, files)))
    found = read_launch_plan(package, tmp_path / "ws", dict(os.environ))
    place = "launch/robocop_goto_as.launch, line"
    assert {part: choice.path.name for part, choice in found.choices.items()} == {
        "server": "robocop_goto_as.py",
        "bridge": "goto.py",
    }
    assert found.notes == [
        f"{place} 2: roslaunch finds no none.py in this package",
        f"{place} 3: node n2 (tf2_ros static) is not started: server and bridge are graded one at a time, each alone",
        f"{place} 5: pkg='other' is not this package, whose name is '{LAB}'",
    ]


def test_packages_are_known_that_the_launch_file_starts_itself_or_by_another_unless_a_condition_leaves_them_out(
    tmp_path,
):
    nodes = '<node pkg="gazebo_ros" type="a" name="a" if="$(arg all)"/><node pkg="aro_sim" type="b" name="b"/>'
    files = {
        "package.xml": MANIFEST.format(LAB),
        "launch/robocop_goto_as.launch": '<launch><arg name="all" default="1"/>'
        '<include file="$(dirname)/nodes.launch" pass_all_args="true"/></launch>',
        "launch/nodes.launch": f'<launch><arg name="all"/>{nodes}</launch>',
        "scripts/robocop_goto_as.py": "",
    }
    package = find_package(str(tree(tmp_path / "src" / LAB, files)))
    for words, starts in (([], {"gazebo_ros", "aro_sim"}), (["all:=0"], {"aro_sim"})):
        found = read_launch_plan(package, tmp_path, dict(os.environ), words)
        assert {node.package for node in found.others} == starts


def test_launch_file_of_the_other_part_decides_among_its_scripts(tmp_path):
    node = f'<launch><node pkg="{LAB}" type="{{0}}" name="n"><param name="of" value="{{0}}"/></node></launch>'
    files = {
        "package.xml": MANIFEST.format(LAB),
        "launch/robocop_goto_as.launch": node.format("robocop_goto_as.py"),
        "launch/clicks.launch": node.format("second.py"),
        "launch/gazebo.launch": '<launch><include file="$(find no_such)/x.launch"/></launch>',
        "scripts/robocop_goto_as.py": "",
        "scripts/first.py": "'move_base_simple'  # 1",
        "scripts/second.py": "'move_base_simple'  # 2",
    }
    package = find_package(str(tree(tmp_path / "src" / LAB, files)))
    found = read_launch_plan(package, tmp_path, dict(os.environ))
    assert found.choices["bridge"].path.name == "second.py"
    assert (found.parameters, found.notes) == ({"/n/of": "robocop_goto_as.py"}, [])
