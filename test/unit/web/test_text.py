"""The page's texts: what looks like markup in them is shown as text."""

from aro_robocop_goto_as.web import text


def test_markup_in_names_and_messages_is_shown_as_text():
    attack = "<img src=x onerror=alert(1)>"
    for content in (
        text.alert(attack),
        text.answer(attack),
        text.table([(attack, attack)]),
        text.report(attack),
        text.legend(attack, {attack: (1, 2, 3)}),
        text.link(attack, attack),
    ):
        assert "<img" not in content and "&lt;img" in content


def test_an_endless_message_is_cut():
    assert len(text.plain("x" * 10_000)) == text.MAX_LENGTH
