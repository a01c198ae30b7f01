"""The lab's steps as the page reads them from docs/lab.md."""

from pathlib import Path

from aro_robocop_goto_as.ros.web.lab import LAB, read_lab
from aro_robocop_goto_as.web import text

PAGE = """# The lab

## Start

./robocop run

## 1. First

**You will see** a list
of `topics`.

```
rostopic list
rosnode list
```

```
/clock
```

Some words.

```python
import rospy
```

## 2. Second
"""


def test_a_section_has_what_one_will_see_and_its_commands_with_what_they_print(tmp_path: Path) -> None:
    page = tmp_path / "lab.md"
    page.write_text(PAGE)
    first, second = read_lab(page)
    assert (first.title, first.expected) == ("1. First", "a list of `topics`.")
    assert first.steps == (("rostopic list\nrosnode list\n", "/clock\n"), ("import rospy\n", ""))
    assert (second.title, second.expected, second.steps) == ("2. Second", "", ())
    shown = text.steps(first.expected, first.steps)
    assert "You will see a list of <code>topics</code>." in shown and "user-select:all" in shown


def test_every_section_of_the_lab_says_what_one_will_see_and_has_a_command() -> None:
    sections = read_lab()
    assert [section.title.partition(".")[0] for section in sections] == [str(n) for n in range(1, len(sections) + 1)]
    assert len(sections) == LAB.read_text(encoding="utf-8").count("\n## ") - 1  # all but "Start"
    for section in sections:
        assert section.expected and section.steps, section.title
        assert not [command for command, _ in section.steps if command.startswith(("[", "$", "SUCCEEDED"))]


def test_there_are_no_steps_where_the_documents_are_not_installed(tmp_path: Path) -> None:
    assert read_lab(tmp_path / "lab.md") == []
