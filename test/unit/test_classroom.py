"""Hand-ins of a class are collected and packed; their results are stored, listed and summarized."""

import csv
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import warnings
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading.classroom import main as classroom
from aro_robocop_goto_as.grading.classroom import overview, worker
from aro_robocop_goto_as.grading.classroom.hand_ins import HandIn, collect, pack, unpack
from aro_robocop_goto_as.grading.classroom.main import class_seed
from aro_robocop_goto_as.grading.classroom.results import Check, Result, Results, table
from aro_robocop_goto_as.grading.classroom.worker import Done
from aro_robocop_goto_as.grading.plan import load
from aro_robocop_goto_as.grading.scenario_draw import LARGEST_SEED
from aro_robocop_goto_as.hosting.workspace import exclusive

PLAN = load(Path(__file__).resolve().parents[2] / "config" / "grading.yaml")


@pytest.fixture
def folder(tmp_path):
    """Anna handed in a folder, Ben a file; the other entries are not hand-ins."""
    top = tmp_path / "class"
    (top / "anna" / "scripts").mkdir(parents=True)
    (top / "anna" / "scripts" / "robocop_goto_as.py").write_text("one")
    (top / "anna" / "build").mkdir()
    (top / "anna" / "build" / "big").write_text("a build product")
    (top / "ben.py").write_text("two")
    (top / "list.csv").write_text("anna,ben")
    (top / ".hidden.py").write_text("")
    (top / "link.py").symlink_to(top / "ben.py")
    return top


def only(folder):
    """The only hand-in of a folder, packed."""
    (hand_in,), _ = collect(folder)
    assert not hand_in.packed, "those of a large class don't fit into memory"
    packed = pack(hand_in.path)
    assert (packed.digest, packed.problem) == (hand_in.digest, hand_in.problem)
    return packed


def test_folders_and_python_files_are_hand_ins_and_are_unpacked_unchanged(folder, tmp_path):
    hand_ins, others = collect(folder)
    assert [hand_in.name for hand_in in hand_ins] == ["anna", "ben.py"]
    assert others == ["link.py", "list.csv"]
    assert [hand_in.problem for hand_in in hand_ins] == ["", ""]
    anna, ben = (unpack(pack(hand_in.path), tmp_path / "out") for hand_in in hand_ins)
    assert (anna / "scripts" / "robocop_goto_as.py").read_text() == "one"
    assert not (anna / "build").exists()
    assert ben.read_text() == "two"


def test_digest_depends_on_contents_but_not_on_times(folder):
    before, _ = collect(folder)
    os.utime(folder / "ben.py", (0, 0))
    assert [hand_in.digest for hand_in in collect(folder)[0]] == [hand_in.digest for hand_in in before]
    (folder / "anna" / "scripts" / "robocop_goto_as.py").write_text("One")
    after, _ = collect(folder)
    assert after[0].digest != before[0].digest and after[1].digest == before[1].digest


def test_a_link_is_packed_as_a_link(tmp_path):
    (tmp_path / "class" / "eve").mkdir(parents=True)
    (tmp_path / "secret").write_text("points")
    (tmp_path / "class" / "eve" / "link").symlink_to(tmp_path / "secret")
    out = unpack(only(tmp_path / "class"), tmp_path / "out")
    assert (out / "link").is_symlink()
    assert b"points" not in only(tmp_path / "class").packed


def test_zip_counts_as_the_folder_that_it_contains(tmp_path):
    (tmp_path / "class" / "eve").mkdir(parents=True)
    (tmp_path / "class" / "eve" / "run.sh").write_text("one")
    (tmp_path / "class" / "eve" / "run.sh").chmod(0o755)
    eve = only(tmp_path / "class")
    shutil.make_archive(str(tmp_path / "zipped" / "eve"), "zip", tmp_path / "class" / "eve")
    (tmp_path / "moodle" / "eve").mkdir(parents=True)
    shutil.copy(tmp_path / "zipped" / "eve.zip", tmp_path / "moodle" / "eve" / "lab.zip")
    for folder in ("zipped", "moodle"):
        again = only(tmp_path / folder)
        assert again.problem == "" and again.digest == eve.digest
        script = unpack(again, tmp_path / f"out_{folder}") / "run.sh"
        assert script.read_text() == "one" and os.access(script, os.X_OK)


@pytest.mark.parametrize(
    "name, megabytes, problem",
    [
        ("../../evil.py", 0, "../../evil.py: expected a path within the zip"),
        ("/etc/evil.py", 0, "/etc/evil.py: expected a path within the zip"),
        ("bomb.py", 65, "larger than 64 MB"),
        ("", 0, "can't be read: File is not a zip file"),
    ],
)
def test_malicious_or_broken_zip_is_refused(name, megabytes, problem, tmp_path):
    with open(tmp_path / "eve.zip", "wb") as file:
        if not name:
            file.write(b"PK no zip at all")
        else:
            with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr(name, bytes(megabytes * 1024**2))
    assert only(tmp_path).problem == problem


def test_hand_in_that_cannot_be_packed_states_the_reason(tmp_path):
    (tmp_path / "pipes" / "eve").mkdir(parents=True)
    os.mkfifo(tmp_path / "pipes" / "eve" / "pipe")
    assert only(tmp_path / "pipes").problem == "pipe: expected a file, folder or link"
    (tmp_path / "large" / "eve").mkdir(parents=True)
    with open(tmp_path / "large" / "eve" / "hole", "wb") as hole:
        hole.truncate(10**12)
    assert only(tmp_path / "large").problem == "larger than 64 MB"


def test_a_folder_without_hand_ins_is_refused(tmp_path):
    with pytest.raises(GradingError, match="no hand-ins"):
        collect(tmp_path)
    with pytest.raises(GradingError, match="expected a folder with one folder, zip or Python file"):
        collect(tmp_path / "nothing")


def report(name, points, cause=""):
    """A worker's result with one check."""
    failure = {"cause": cause} if cause else None
    check = {
        "name": "cancel",
        "part": "server",
        "outcome": "failed" if cause else "passed",
        "points": points,
        "failure": failure,
    }
    raw = json.dumps({"name": name, "checks": [check], "problems": []}).encode()
    return Done(name, f"digest of {name}", {"report.json": raw, "report.html": b"<html>"}, 3.0, "here")


def test_stored_result_is_valid_until_hand_in_or_plan_change(tmp_path):
    results = Results(tmp_path, {"plan": "1"})
    hand_in = HandIn("anna", digest="digest of anna")
    assert not results.has(hand_in)
    results.keep(report("anna", 0.2))
    assert results.has(hand_in)
    assert results.read("anna").points == 0.2
    assert not results.has(HandIn("anna", digest="another"))
    assert not Results(tmp_path, {"plan": "2"}).has(hand_in)
    results.keep(report("anna", 0.1))
    assert results.read("anna").points == 0.1


@pytest.mark.parametrize("used", [0, 7])
def test_class_keeps_its_seed_unless_another_one_is_given(used, tmp_path):
    Results(tmp_path, {"seed": used}).keep(report("anna", 0.2))
    assert class_seed(None, tmp_path) == used
    assert class_seed(3, tmp_path) == 3


def test_gradings_of_a_new_class_at_the_same_time_share_a_seed(tmp_path):
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "anna.py").write_text("one")
    out = tmp_path / "out"
    code = f"from {classroom.__name__} import main; main()"
    command = [sys.executable, "-u", "-c", code, tmp_path / "class", "--report", out]
    with exclusive(out / ".run"):  # the first one is running
        second = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert "waiting for another process" in second.stderr.readline()
        Results(out, {"seed": 4711}).keep(report("anna", 0.2))
    try:
        assert [second.stdout.readline() for _ in range(2)][1] == "scenarios: seed 4711\n"
    finally:
        second.kill()
        second.communicate()


def test_new_class_gets_a_seed_that_draws(tmp_path):
    assert 1 <= class_seed(None, tmp_path / "not there yet") <= LARGEST_SEED


def test_incomplete_result_is_ignored_and_removed(tmp_path):
    results = Results(tmp_path, {})
    results.keep(report("anna", 0.2))
    (tmp_path / "anna" / "hand_in.json").write_text("{")
    assert not results.has(HandIn("anna", digest="digest of anna"))
    shutil.copytree(tmp_path / "anna", tmp_path / ".new-anna")
    Results(tmp_path, {})
    assert sorted(path.name for path in tmp_path.iterdir()) == ["anna"]


RESULTS = (
    Result(
        "=anna",
        (Check("cancel", "server", "failed", 0.0, "<cause> at 1.5"), Check("action_server", "server", "passed", 0.5)),
        (),
        9.0,
    ),
    Result("ben", (Check("cancel", "server", "failed", 0.0, "<cause> at -3"),), ("=cmd",), 9.0),
    Result("carl", (), ("nothing to grade",), 9.0),
)


def read(text):
    """The rows of a table that starts with a byte order mark."""
    assert text[0] == "\ufeff"
    return list(csv.DictReader(io.StringIO(text[1:])))


def test_table_has_one_row_per_hand_in_and_no_spreadsheet_formulas():
    rows = read(table(RESULTS, PLAN))
    assert [row["name"] for row in rows] == ["'=anna", "ben", "carl"]
    assert [row["points"] for row in rows] == ["0.5", "0.0", "0"]
    assert {row["of"] for row in rows} == {"8.0"}
    assert [row["server"] for row in rows] == ["0.5", "0.0", "not handed in"]
    assert {row["bridge"] for row in rows} == {"not handed in"}
    assert [row["cancel"] for row in rows] == ["failed", "failed", "not handed in"]
    assert rows[1]["problem"] == "'=cmd"


def test_the_overview_counts_checks_and_causes_and_escapes_them():
    html = overview.page("class <1>", RESULTS, PLAN, {"dora": "waiting"}, running=True)
    assert "3 of 4 graded, in progress" in html and "http-equiv='refresh'" in html
    assert "2 × &lt;cause&gt; at 1.5" in html and "<cause>" not in html and "<1>" not in html
    assert "0 of 2" in html, "of the two that handed in a server"
    assert "dora" in html
    assert "interrupted" in overview.page("class", RESULTS, PLAN, {"dora": "waiting"}, running=False)
    assert "http" not in overview.page("class", RESULTS, PLAN, {}, running=False)


@given(st.text(), st.text())
def test_no_name_or_problem_controls_a_spreadsheet_whatever_separator_it_is_read_with(name, problem):
    text = table([Result(name, (), (problem,), 1.0)], PLAN, {name: problem})
    assert len(read(text)) == 2
    for separator in ",;\t":
        for row in csv.reader(io.StringIO(text[1:]), delimiter=separator):
            for cell in row:
                assert cell.isprintable()
                assert not cell.lstrip(" '\"").startswith(("=", "+", "@", "\uff1d")) or cell.startswith("'")


def test_hand_in_that_could_not_be_graded_has_a_row_without_points():
    (row,) = read(table([], PLAN, {"dora": "could not be graded: a worker died"}))
    assert (row["name"], row["points"], row["problem"]) == ("dora", "", "could not be graded: a worker died")
    assert row["of"] == "8.0" and not row["cancel"]


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    # zipfile ends a name at its first NUL, and can't write an empty one.
    files=st.dictionaries(st.text(min_size=1).filter(lambda name: name[0] != "\0"), st.binary(max_size=20), max_size=5),
    noise=st.binary(max_size=30),
)
def test_no_zip_stops_the_class(files, noise, tmp_path):
    tmp_path = Path(tempfile.mkdtemp(dir=tmp_path))
    with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a name that occurs twice
        for name, content in files.items():
            archive.writestr(name.encode("utf-8", "replace").decode(), content)
    (tmp_path / "carl.zip").write_bytes(noise)
    carl, eve = collect(tmp_path)[0]
    assert carl.problem
    assert bool(eve.problem) != bool(eve.digest)


@pytest.mark.parametrize("kind", ["folder", "zip"])
def test_deeply_nested_hand_in_states_the_reason(kind, tmp_path):
    nested = "/".join("d" * 1500)
    if kind == "zip":
        with zipfile.ZipFile(tmp_path / "eve.zip", "w") as archive:
            archive.writestr(f"{nested}/file", "")
    else:
        # No deeper than pytest, which removes the folder in a later run, can recurse; test_tree.py goes deeper.
        (tmp_path / "eve" / nested[:300]).mkdir(parents=True)
    assert "expected at most 100 nested folders" in only(tmp_path).problem


@pytest.mark.parametrize(
    "error", [RecursionError("too deep"), TypeError("a date"), MemoryError(), OSError(7, "too long")]
)
def test_whatever_a_hand_in_makes_of_the_grader_is_its_own_row(error, folder, monkeypatch):
    def fails(*_):
        raise error

    monkeypatch.setattr(worker, "open_sandbox", lambda *_: None)
    monkeypatch.setattr(worker, "prepare_submission", fails)
    monkeypatch.setattr(worker, "_scratch", lambda: None)
    monkeypatch.setenv("ROBOCOP_STATE", "/nowhere")
    monkeypatch.setenv("ROBOCOP_SHARE", "/nowhere")
    anna = pack(folder / "anna")
    done = worker.work(worker.Task(anna, PLAN.path.read_text(), 0))
    report = json.loads(done.files["report.json"])
    assert report["checks"] == [] and type(error).__name__ in report["problems"][0]
