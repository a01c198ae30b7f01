"""bench.client: messages on connections are counted, and those that are missing."""

import socket
import struct
import time

import pytest
from bench.client import Client

SECOND = 10**9


@pytest.mark.parametrize("left_out, chunk", [((), 10**6), ((), 7), ((3, 4), 7)])
def test_messages_are_counted_however_the_stream_is_split_and_missing_ones_are_lost(tmp_path, left_out, chunk):
    stamps = [number for number in range(20) if number not in left_out]
    headers = (struct.pack("<IIII", 112, 0, number // 10, number % 10 * SECOND // 10) for number in stamps)
    stream = b"".join(header + bytes(100) for header in headers)
    with Client({"/scan": 10}, tmp_path, "http://localhost:1") as client, socket.create_server(
        ("127.0.0.1", 0)
    ) as server:
        with socket.create_connection(server.getsockname()) as sender:
            client._add("/scan", server.accept()[0])
            for start in range(0, len(stream), chunk):
                sender.sendall(stream[start : start + chunk])
        deadline = time.monotonic() + 60.0
        while client.links["/scan"].open:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        assert client.newest_ns == 19 * SECOND // 10 and client.first_scan_at() > 0.0
        assert client.deliveries() == (19, 19 - len(left_out))  # without the newest one
