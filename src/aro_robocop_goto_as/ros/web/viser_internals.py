"""Uses private parts of viser, for one purpose: checking HTTP requests before it answers them."""

import contextlib
import socket
from typing import Any, Callable, Dict, Iterator, Optional

LARGEST_REQUEST = 1 << 20  # [byte] that a page may send at once


@contextlib.contextmanager
def checked_requests(
    refusal: Callable[[Any], str], headers: Dict[str, str], listening: Optional[socket.socket] = None
) -> Iterator[None]:
    """A viser server made in this block answers only HTTP requests for which `refusal` returns an empty string.

    Every answer gets these headers. With a `listening` socket it accepts its connections, and opens no port itself.
    viser passes no such options on to websockets' serve(), which it calls before its constructor returns.
    """
    from websockets.asyncio import server as websockets_server  # not installed where the page has never been used

    serve = websockets_server.serve

    def checking_serve(handler: Any, host: str, port: int, process_request: Any, **options: Any) -> Any:
        def process(connection: Any, request: Any) -> Any:
            reason = refusal(request.headers)
            response = connection.respond(403, reason + "\n") if reason else process_request(connection, request)
            if response is not None:
                response.headers.update(headers)
            return response

        options = {**options, "process_request": process, "max_size": LARGEST_REQUEST}
        return serve(handler, host, port, **options) if listening is None else serve(handler, sock=listening, **options)

    setattr(websockets_server, "serve", checking_serve)  # noqa: B010  mypy refuses to assign to a module's function
    try:
        yield
    finally:
        setattr(websockets_server, "serve", serve)  # noqa: B010
