"""Which requests the page answers, and where it listens."""

import socket

import pytest

from aro_robocop_goto_as.web import access
from aro_robocop_goto_as.web.access import is_loopback, refusal, url

PROXY = "https://proxy.example"


@pytest.mark.parametrize(
    "host", ["localhost:8080", "127.0.0.1:8080", "[::1]:8080", "192.168.1.5", "LOCALHOST", "pc-7:80"]
)
def test_requests_of_our_own_page_and_without_an_origin_are_answered(host):
    assert refusal([host], [f"http://{host}"], ["pc-7"], []) == ""
    assert refusal([host], [], ["pc-7"], []) == ""


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "http://localhost:9999",
        "http://localhost",
        "http://localhost:8080.evil.example",
        "http://evil.example/localhost:8080",
        "null",
        "file://localhost:8080",
    ],
)
def test_requests_of_other_origins_are_refused_also_beside_our_own(origin):
    assert refusal(["localhost:8080"], [origin], [], [])
    assert refusal(["localhost:8080"], ["http://localhost:8080", origin], [], [])


def test_a_name_that_was_made_to_point_here_is_refused_although_page_and_request_agree():
    assert refusal(["evil.example:8080"], ["http://evil.example:8080"], [], [])


@pytest.mark.parametrize("hosts", [[], ["localhost", "evil.example"], [""], ["["], ["[::1"]])
def test_a_missing_double_or_malformed_host_is_refused(hosts):
    assert refusal(hosts, [], [], [])


def test_an_origin_that_is_allowed_is_answered_and_no_other_one():
    assert refusal(["localhost:8080"], [PROXY], [], [PROXY]) == ""
    assert refusal(["localhost:8080"], [PROXY + ".evil.example"], [], [PROXY])


def test_loopback_addresses_are_told_from_those_that_others_reach():
    assert [is_loopback(name) for name in ("127.0.0.1", "::1", "localhost", "127.9.9.9")] == [True] * 4
    assert [is_loopback(name) for name in ("0.0.0.0", "::", "192.168.1.5", "pc-7", "")] == [False] * 5


def test_a_server_on_all_addresses_is_opened_at_this_machines_own_but_in_a_container_at_localhost(monkeypatch):
    monkeypatch.setattr(access, "own_address", lambda: "192.0.2.7")
    assert {url(host, 80) for host in ("127.0.0.1", "::1")} == {"http://localhost:80"}
    assert {url(host, 80) for host in ("0.0.0.0", "::")} == {"http://192.0.2.7:80"}
    assert url("192.168.1.5", 8090) == "http://192.168.1.5:8090"
    monkeypatch.setenv(access.HOST_VARIABLE, "0.0.0.0")
    assert url("0.0.0.0", 80) == "http://localhost:80"


def test_this_machines_own_address_is_one_that_it_can_listen_on():
    with socket.socket() as server:
        server.bind((access.own_address(), 0))
