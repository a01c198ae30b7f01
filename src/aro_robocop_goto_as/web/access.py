"""Where the page listens, and which HTTP and WebSocket requests it answers: only those from its own pages."""

import contextlib
import ipaddress
import os
import socket
from typing import Sequence
from urllib.parse import urlsplit

from ..errors import WebError

LOOPBACK_NAMES = ("localhost", "localhost.localdomain")
ANY_ADDRESS = ("0.0.0.0", "::")
HOST_VARIABLE = "ROBOCOP_WEB_HOST"  # the address to listen on where none is given; set in the container image
# Nothing from other servers, and not inside another site's frame. The page's one file holds its scripts and styles;
# viser decodes messages in a WebAssembly module, in workers made from blobs, and compiles functions at run time.
CONTENT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' blob:; worker-src blob:; "
    "style-src 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; connect-src 'self' ws: wss: data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


def refusal(hosts: Sequence[str], origins: Sequence[str], names: Sequence[str], allowed: Sequence[str]) -> str:
    """Why a request is refused, or an empty string.

    hosts, origins: all values of the request's headers Host and Origin
    names: host names that mean this machine, besides localhost and any numeric address
    allowed: further origins, such as a proxy's, as https://host:port

    A page of another site has another origin than the host it asks. With DNS rebinding, where that site's name points
    to this machine, both are the same; but the name is none of this machine's.
    """
    if len(origins) > 1 or len(hosts) != 1:
        return "expected one Host and at most one Origin header"
    if not _is_ours(hosts[0], names):
        return f"the host {hosts[0]!r} is not this machine"
    if not origins or origins[0] in allowed:
        return ""
    origin = urlsplit(origins[0])
    if origin.scheme in ("http", "https") and origin.netloc.lower() == hosts[0].lower():
        return ""
    return f"requests from {origins[0]!r} are not answered"


def _is_ours(host: str, names: Sequence[str]) -> bool:
    try:
        name = urlsplit("//" + host).hostname or ""  # without the port, in lower case
        known = name in LOOPBACK_NAMES or name in [known.lower() for known in names if known]
        return known or bool(ipaddress.ip_address(name))
    except ValueError:  # a malformed header, or a name that is no address
        return False


def default_host() -> str:
    """The address to listen on where none is given."""
    return os.environ.get(HOST_VARIABLE) or "127.0.0.1"


def url(host: str, port: int) -> str:
    """Where a browser finds a server that listens on this address, or on all addresses.

    Other machines do not reach a container's own address, so there it is localhost, to which the port is forwarded.
    """
    if host in ANY_ADDRESS:
        host = "localhost" if HOST_VARIABLE in os.environ else own_address()
    return f"http://{'localhost' if is_loopback(host) else host}:{port}"


def own_address() -> str:
    """This machine's address in its network; localhost if it has none."""
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))  # an address for documentation; nothing is sent
        return str(probe.getsockname()[0])
    return "localhost"


def is_loopback(address: str) -> bool:
    """Return whether a server bound to this address can be reached from this machine only."""
    if address.lower() in LOOPBACK_NAMES:
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def require_free(host: str, port: int) -> None:
    """WebError if the page can't listen at this address and port."""
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind(address)
    except OSError as error:
        raise WebError(
            f"can't open {host}:{port}: {error.strerror or error}; choose another address with web_host:=ADDRESS, "
            "or another port with web_port:=N"
        ) from error
