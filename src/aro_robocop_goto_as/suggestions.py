"""The end of a message about a mistyped word: "; did you mean ...?"."""

from typing import Iterable


def did_you_mean(word: str, known: Iterable[str], form: str = "{}") -> str:
    """The end of an error message about a mistyped word, which shows the one meant; empty if none is similar."""
    import difflib  # only where there is an error

    close = difflib.get_close_matches(word, list(known), n=1)
    return f"; did you mean {form.format(close[0])}?" if close else ""
