"""The end of a message about an unknown word: the known words, or the word that was probably meant."""

from typing import Collection, Iterable

MAX_LINE = 78  # characters; `rosservice call` wraps a longer text


def did_you_mean(word: str, known: Iterable[str], form: str = "{}") -> str:
    """The end of an error message about a mistyped word, with the word that was meant; empty if no word is similar."""
    import difflib  # only where there is an error

    close = difflib.get_close_matches(word, list(known), n=1)
    return f"; did you mean {form.format(close[0])}?" if close else ""


def unknown(text: str, word: str, known: Collection[str]) -> str:
    """A message about an unknown word, with the known words if they fit in one line, else with the one meant."""
    full = f"{text}; there are: {', '.join(known) or 'none'}"
    return full if len(full) <= MAX_LINE else text + did_you_mean(word, known)
