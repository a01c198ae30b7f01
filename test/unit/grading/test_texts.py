"""config/grading_texts.yaml lists every text of checks and causes; a translated copy of it tells them all."""

import ast
import re
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from grading_records import PLAN, RIGHT, changed, commanded
from support import ROOT

from aro_robocop_goto_as.errors import PlanError
from robocop_grading.checks import CHECKS
from robocop_grading.checks.feedback_causes import CAUSES, OTHERWISE
from robocop_grading.judge import Outcome, judge
from robocop_grading.plan import load
from robocop_grading.record import Record
from robocop_grading.texts import ENGLISH, Texts, sentences, text
from robocop_grading.texts import load as load_texts

SOURCE = Path(ROOT, "src", "robocop_grading")
FILE = Path(ROOT, "config", "grading_texts.yaml")
LISTED = yaml.safe_load(FILE.read_text(encoding="utf-8"))
NAMED = {name for name, told in LISTED.items() if told}  # long texts
# Texts of one word, and strings with spaces that nobody reads.
SHORT = {"none", "contact", "large", "small", "left", "right", "backward"}
NOT_TOLD = {"the node did not come up", "another position", "too early", "late success", "no answer", "a long turn"}
NOT_TOLD |= {"of the position", "too late", "an exception", "not cancelled", "not reset", "moves first"}
NOT_TOLD |= {"no report", "empty report", "untrue report", "nothing was judged"}


def told_in(path):
    """The texts of a module, and its f-strings that look like a text: these can't be translated."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    left_out = {id(node.body[0].value) for node in ast.walk(tree) if hasattr(node, "body") and is_docstring(node)}
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    left_out |= {id(part) for it in calls if "compile" in ast.unparse(it.func) for part in ast.walk(it)}
    fixed = {id(part) for it in ast.walk(tree) if isinstance(it, ast.JoinedStr) for part in ast.walk(it)}
    texts = {
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in left_out | fixed
        if re.search("[a-z]", node.value) and (" " in node.value.strip() or node.value in SHORT | NAMED)
    }
    words = {
        "".join(it.value for it in node.values if isinstance(it, ast.Constant))
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr) and id(node) not in left_out
    }
    return texts - NOT_TOLD, {it for it in words if re.search("[a-z]{3}.* [a-z]{2}|[a-z]{2} [a-z]{3}", it)}


def is_docstring(node):
    """Whether a body begins with a docstring."""
    first = node.body[0] if isinstance(node.body, list) and node.body else None
    return isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)


def test_file_lists_every_text_of_checks_and_causes():
    modules = [path for path in sorted((SOURCE / "checks").glob("*.py")) if path.name != "output.py"]
    wanted, fixed = {check.contract for check in CHECKS.values()}, set()
    for path in [*modules, SOURCE / "judge.py"]:
        texts, others = told_in(path)
        wanted |= texts
        fixed |= others
    assert fixed == set(), "use text() instead of an f-string"
    assert sorted(wanted - set(LISTED)) == [] and sorted(set(LISTED) - wanted) == []


def test_what_looks_like_the_name_of_a_text_is_one():
    calls = re.compile(r'\btext\(\s*"(\w+)"')
    used = [name for path in (SOURCE / "checks").glob("*.py") for name in calls.findall(path.read_text("utf-8"))]
    assert len(used) > 50 and set(used) <= NAMED
    assert {name for causes in CAUSES for name, _ in causes} | set(OTHERWISE) <= NAMED


def test_translation_tells_contract_cause_and_values(tmp_path):
    lines = {
        "While angle_error is beyond 0.1 rad the robot turns towards the goal without driving.": "Er dreht sich.",
        "drives_while_turning": "Er fährt beim Drehen",
        "linear.x {:.2f} at {:.2f} rad": "bei {1:.1f} rad {0:.2f} m/s",
        "failed: {} Expected {}, got {}, at {:.1f} s of scenario {}": "Fehler: {0} {2} in {4}",
    }
    (tmp_path / "german.yaml").write_text(yaml.safe_dump(lines, allow_unicode=True), encoding="utf-8")
    plan = load(PLAN, texts=load_texts(tmp_path / "german.yaml"))
    grade = judge("x", plan, {"server": {"left": commanded(lambda c: replace(c, v=0.1))}}, {})
    check = next(check for check in grade.checks if check.name == "turns_to_goal")
    assert check.sentence == "Er dreht sich."
    assert check.words == "Fehler: Er fährt beim Drehen. bei 0.6 rad 0.10 m/s in left"
    assert grade.mistakes[0].sentence == "Er fährt beim Drehen."


def test_same_grade_in_every_language():
    backward = {"server": {"left": changed(results=()), "start": replace(RIGHT, name="start")}}
    here = judge("x", load(PLAN), backward, {})
    there = judge("x", load(PLAN, texts=Texts({"The robot": "Der"})), backward, {})
    assert [(it.outcome, it.points, it.follows) for it in here.checks] == [
        (it.outcome, it.points, it.follows) for it in there.checks
    ]
    assert any(it.outcome is Outcome.FAILED for it in here.checks)


def test_text_in_text_and_sentences_are_told():
    told = Texts({"no goal": "kein Ziel", "a goal at {}": "ein Ziel bei {}", "It is late": "Es wird dunkel"}).told
    assert told(sentences("It is late", text("a goal at {}", "no goal"))) == "Es wird dunkel. ein Ziel bei kein Ziel."
    assert told("something else") == ENGLISH.told("something else") == "something else"


def test_english_beside_a_text_replaces_it(monkeypatch):
    monkeypatch.setattr("robocop_grading.texts._english", lambda: {"too late": "after 3 s", "{} m": "{} metres"})
    assert [ENGLISH.told(what) for what in ("too late", text("{} m", 2), "late")] == ["after 3 s", "2 metres", "late"]


@pytest.mark.parametrize(
    "content, words",
    [
        ("nobody says this: niemand", "unknown text: 'nobody says this'"),
        ('"a turn of about {:.1f} rad": "{} und {}"', "expected the same values in brackets"),
        ("[one]", "expected texts by text"),
        ("a: [", "while parsing"),
    ],
)
def test_wrong_file_of_texts_is_refused_with_the_mistake(content, words, tmp_path):
    (tmp_path / "texts.yaml").write_text(content)
    with pytest.raises(PlanError, match=re.escape(words)):
        load_texts(tmp_path / "texts.yaml")


def test_record_without_anything_is_told():
    assert judge("x", load(PLAN), {"server": {"start": Record("start", "server", up=False)}}, {}).checks
