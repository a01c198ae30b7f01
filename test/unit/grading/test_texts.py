"""config/grading_texts.yaml has the longer texts of causes, by the names that the code uses."""

import re
import string
from pathlib import Path

import pytest
import yaml
from support import ROOT

from robocop_grading.checks.feedback_causes import CAUSES, NEVER_FILLED, OTHERWISE
from robocop_grading.texts import text

TEXTS = yaml.safe_load(Path(ROOT, "config", "grading_texts.yaml").read_text(encoding="utf-8"))
SOURCES = [path.read_text("utf-8") for path in sorted(Path(ROOT, "src", "robocop_grading").rglob("*.py"))]


def test_every_name_that_the_code_uses_has_a_text_and_every_text_is_used():
    strings = {word for source in SOURCES for word in re.findall(r'"(\w+)"', source)}
    called = {word for source in SOURCES for word in re.findall(r'[ (]text\(\s*"(\w+)"', source)}
    assert len(called) > 50 and set(TEXTS) <= strings
    assert called | {name for causes in CAUSES for name, _ in causes} | {*OTHERWISE, *NEVER_FILLED} <= set(TEXTS)


@pytest.mark.parametrize("name", TEXTS)
def test_text_is_a_format_string(name):
    fields = [(field, spec) for _, field, spec, _ in string.Formatter().parse(TEXTS[name]) if field is not None]
    assert "{" not in text(name, *(1.5 if spec else "x" for _, spec in fields))
