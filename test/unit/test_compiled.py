"""The compiled libraries: how they are found and checked, what C may read, and that it reads nothing else."""

import os
import subprocess
import sys

import numpy as np
import pytest
from support import ROOT

from aro_robocop_goto_as import compiled
from aro_robocop_goto_as.errors import InstallationError

NAME = compiled.file_name("caster")
SOURCES = {
    "caster": ["raycast/caster.c", "sensors/lidar.c"],
    "batch": ["ros/publishing/batch.c"],
    "fleet": ["robot/base_controller.c", "physics/kinematic.c", "sensors/odometry.c"],
}
ARRAYS = {
    "shape": (np.zeros((4, 2)), r"^footprints: expected shape \('any', 3\), got \(4, 2\)"),
    "dimensions": (np.zeros(3), r"^footprints: expected shape \('any', 3\), got \(3,\)"),
    "type": (np.zeros((4, 3), np.float32), "^footprints: expected a C-contiguous array of float64, got float32"),
    "order": (
        np.zeros((3, 4)).T,
        r"^footprints: expected a C-contiguous array of float64, got float64, strides \(8, 32\)",
    ),
}


@pytest.mark.parametrize("case", ARRAYS)
def test_array_of_wrong_shape_type_or_layout_is_refused_by_name(case):
    array, message = ARRAYS[case]
    with pytest.raises(ValueError, match=message):
        compiled.address("footprints", array, (None, 3))


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (None, rf"^{NAME} is in none of /.*: build .*\./robocop setup"),
        ("", "can't be used .*aro_caster_version.*: build"),
        ("int aro_caster_version(void) { return 99; }", "has version 99, these sources need version 7: build"),
    ],
)
def test_library_that_is_missing_or_of_other_sources_is_refused_with_the_command_to_build_it(
    tmp_path, monkeypatch, source, message
):
    monkeypatch.setattr(compiled, "package_folders", [str(tmp_path)])
    if source is not None:
        command = ["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", str(tmp_path / NAME)]
        subprocess.run(command, input=source, text=True, check=True)
    with pytest.raises(InstallationError, match=message):
        compiled.load("caster", "raycast/caster.c")


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory):
    """A folder with the libraries, built with the address and undefined-behaviour sanitizers."""
    folder = str(tmp_path_factory.mktemp("sanitized"))
    checks = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"]
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    for name, sources in SOURCES.items():
        paths = [os.path.join(ROOT, "src", "aro_robocop_goto_as", source) for source in sources]
        options = ["-std=c99", "-g", "-O1", "-fopenmp-simd", *warnings, *checks, "-fPIC", "-shared"]
        path = os.path.join(folder, compiled.file_name(name))
        subprocess.run(["cc", *options, *paths, "-lm", "-o", path], check=True)
    return folder


# pytest with the libraries of the folder that is its first argument
PROGRAM = """
import os, sys
import pytest
from aro_robocop_goto_as import compiled
folder, *arguments = sys.argv[1:]
compiled.find = lambda name: os.path.join(folder, compiled.file_name(name))
sys.exit(pytest.main(["-n", "0", "--capture=sys", *arguments]))
"""
TESTS = (
    *("physics/test_kinematic.py", "raycast/test_compiled_beams.py", "sensors/test_lidar.py"),
    *("sensors/test_odometry.py", "ros/publishing/test_batch.py", "ros/sim/test_sensor_messages.py"),
)


@pytest.mark.slow
def test_sanitizers_report_nothing_in_the_tests_of_what_is_compiled(sanitized):
    runtime = subprocess.run(["cc", "-print-file-name=libasan.so"], check=True, capture_output=True, text=True).stdout
    tests = [os.path.join(os.path.dirname(__file__), test) for test in TESTS]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, sanitized, *tests],
        env={**os.environ, "LD_PRELOAD": runtime.strip(), "ASAN_OPTIONS": "detect_leaks=0", "PYTHONMALLOC": "malloc"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=280,
    )
    assert done.returncode == 0, done.stdout
