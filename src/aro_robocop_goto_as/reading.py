"""Shared by the readers of files that users write: errors that name the file, safe XML, strict numbers."""

import math
import os
import re
from contextlib import contextmanager
from typing import Any, Iterator, Tuple, Type
from urllib.parse import quote, unquote

import yaml
from lxml import etree

from .errors import RobocopError

Element = Any  # lxml.etree._Element, which is private and has no type hints

# float() alone would accept "1_000" and "infinity".
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)

# Or a text in CDATA, which may look like a comment. What is not closed reaches to the end.
_COMMENT = re.compile(rb"(<!\[CDATA\[.*?(?:\]\]>|\Z))|<!--.*?(?:-->|\Z)", re.S)
_LATE_DECLARATION = re.compile(rb"\A(\xef\xbb\xbf)?(\s+)(<\?xml\s.*?\?>)", re.S)


@contextmanager
def reading(path: str, error: Type[RobocopError], expected: str) -> Iterator[None]:
    """The outermost block of a reader: every exception in it becomes an `error`, except for RobocopErrors.

    The message names the file, the line where it is known, what is wrong, and `expected`, such as "a URDF".
    """
    try:
        yield
    except RobocopError:
        raise
    except UnicodeDecodeError as exc:
        raise error(f"{path}: not UTF-8 text: {exc.reason}") from exc
    except RecursionError as exc:
        raise error(f"{path}: nested too deeply; expected {expected}") from exc
    except etree.XMLSyntaxError as exc:
        raise error(f"{path}:{exc.lineno}: not well-formed XML: {_on_one_line(exc.msg)}") from exc
    except yaml.MarkedYAMLError as exc:
        line = f":{exc.problem_mark.line + 1}" if exc.problem_mark else ""
        raise error(f"{path}{line}: not YAML: {exc.problem}") from exc
    except Exception as exc:  # libraries do not document all that they raise for broken files
        if isinstance(exc, OSError) and exc.strerror:
            raise error(f"{path}: can't read the file: {exc.strerror}") from exc
        raise error(f"{path}: {_on_one_line(str(exc)) or type(exc).__name__}; expected {expected}") from exc


def _on_one_line(text: str) -> str:
    return " ".join(text.split())


def parse_xml(text: bytes, path: str, error: Type[RobocopError], lenient: bool = False) -> Element:
    """The root element of an XML text; path: its name for messages. `error` if it is not XML or has a DOCTYPE.

    As in Gazebo, a comment may contain -- and any bytes, and blank lines or comments may precede the <?xml ...?>.
    Elements of xacro are an error: the text does not have the elements that they stand for.
    lenient: reads on after errors, such as a bare & or bytes that are not UTF-8.
    """
    # Line feeds are kept, for the lines that errors name.
    text = _COMMENT.sub(lambda comment: comment[1] or b"\n" * comment[0].count(b"\n"), text)
    text = _LATE_DECLARATION.sub(rb"\1\3\2", text)
    if lenient and b"\0" not in text:  # UTF-16 has such bytes
        text = text.decode("utf-8", "replace").encode()
    # These files are not trusted: a DTD could include other files, or expand its entities without bound.
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        remove_comments=True,
        remove_pis=True,
        recover=lenient,
    )
    with reading(path, error, "XML"):
        # Quoted here because libxml2 quotes only some paths; file_of unquotes it.
        root = etree.fromstring(text, parser, base_url=quote(os.fsencode(path)))
    if root is None:
        raise error(f"{path}: not XML")
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        raise error(f"{path}: '{info.doctype}' is not supported; expected a file without DOCTYPE and entities")
    for macro in root.xpath("//*[contains(namespace-uri(), 'xacro')]"):
        raise error(f"{path}:{macro.sourceline}: <{macro.prefix}:...>, expected the file that xacro makes of it")
    return root


def file_of(element: Element) -> str:
    """The file that contains an element, by the path that it was parsed with."""
    return unquote(element.getroottree().docinfo.URL)


def finite_numbers(text: str, count: int, positive: bool = False) -> Tuple[float, ...]:
    """The `count` finite numbers of a text, separated by blanks; ValueError says what was expected."""
    words = text.split()
    values = tuple(float(word) for word in words if _NUMBER.fullmatch(word))
    if len(words) == len(values) == count and all(map(math.isfinite, values)) and not (positive and min(values) <= 0.0):
        return values
    expected = "one finite number" if count == 1 else f"{count} finite numbers"
    raise ValueError(f"expected {expected}{' greater than 0' if positive else ''}")
