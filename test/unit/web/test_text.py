"""The page's texts: what looks like markup in them is shown as text."""

import pytest

from aro_robocop_goto_as.web import text


def test_markup_in_names_and_messages_is_shown_as_text() -> None:
    attack = "<img src=x onerror=alert(1)>"
    for content in (
        text.alert(attack),
        text.answer(attack),
        text.table([(attack, attack)]),
        text.history([(True, attack)]),
        text.legend(attack, {attack: (1, 2, 3)}),
        text.link(attack, attack),
    ):
        assert "<img" not in content and "&lt;img" in content


@pytest.mark.parametrize(
    "message, shown",
    [
        ("REACHED: 0.098 m from the goal x 0.42 y -0.38 in odom after 8.1 s", "REACHED: 0.10 m off, 8.1 s"),
        ("OBSTACLE: obstacle 0.265 m\nahead (limit 0.3 m)", "OBSTACLE: 0.265 m ahead"),
        (
            "OBSTACLE: obstacle 0.265 m ahead (limit 0.3 m); 0.512 m from the goal x 0.42 y -0.38 in odom after 8.1 s",
            "OBSTACLE: 0.265 m ahead, 0.51 m off, 8.1 s",
        ),
        (
            "PREEMPTED: goal x 0.42 y -0.38 in odom stopped after 2.1 s: it was cancelled",
            "PREEMPTED: it was cancelled, 2.1 s",
        ),
        ("finished successfully", "finished successfully"),
    ],
)
def test_a_message_of_the_server_is_shown_in_fewer_words(message: str, shown: str) -> None:
    assert text.short(message) == shown


def test_the_goal_is_found_in_a_message_of_the_server_and_in_no_other_one() -> None:
    assert text.goal_in("REACHED: 0.098 m from the goal x 0.42 y -0.38 in odom after 8.1 s") == (0.42, -0.38)
    for message in ("finished", "goal x nan y 1.00 in odom", "goal x 1.2.3 y 1.00 in odom", ""):
        assert text.goal_in(message) is None


def test_an_endless_message_is_cut() -> None:
    assert len(text.plain("x" * 10_000)) == text.MAX_LENGTH
