"""Sentences made of parts; other people's texts, made safe to show."""


def sentences(*parts: str) -> str:
    """The parts that are not empty as sentences of one paragraph."""
    return " ".join(part if part.endswith(("?", ".", '."')) else f"{part}." for part in parts if part)


def shortened(text: str, length: int) -> str:
    """The text, cut between two words if it has more than so many characters."""
    return text if len(text) <= length else f"{text[:length].rpartition(' ')[0] or text[:length]} ..."


def printable(text: str) -> str:
    """One line without characters that control a terminal or are not allowed in XML."""
    return "".join(character if character.isprintable() else " " for character in text)


def printable_lines(text: str) -> str:
    """The same for a text that may have several lines."""
    return "\n".join(printable(line) for line in text.split("\n"))
