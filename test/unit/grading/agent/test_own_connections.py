"""What a process sends to itself is waited for, also if it arrives some time later."""

import select

import pytest

from robocop_grading.agent import readers
from robocop_grading.agent.readers import Traffic
from robocop_grading.agent.scheduler import Waiter

LISTENING, CLIENT, ACCEPTED = 3, 4, 5  # descriptors
PORT, OTHER = 5000, 40000


@pytest.fixture
def traffic(monkeypatch):
    """A thread that listens, a connection to it by this process, and who waits for what."""
    traffic = {LISTENING: Traffic((PORT, 0)), CLIENT: Traffic((OTHER, PORT)), ACCEPTED: Traffic((PORT, OTHER))}
    monkeypatch.setattr(readers, "received", traffic)
    monkeypatch.setattr(readers, "closed", [])
    monkeypatch.setattr(readers, "expected", {})
    return traffic


def waits_for(file, monkeypatch):
    monkeypatch.setattr(readers, "reading", {1: Waiter(1, [(file, select.POLLIN)])})


def test_bytes_that_the_process_has_sent_to_itself_are_expected_until_they_are_received(traffic, monkeypatch):
    waits_for(ACCEPTED, monkeypatch)
    assert not readers.more_is_expected()
    traffic[CLIENT].sent = 7
    assert readers.more_is_expected()
    readers.closed.append(traffic.pop(CLIENT))
    assert readers.more_is_expected()
    traffic[ACCEPTED].received = 7
    assert not readers.more_is_expected()


def test_connection_of_the_process_to_itself_is_expected_until_it_is_accepted(traffic, monkeypatch):
    waits_for(LISTENING, monkeypatch)
    accepted = traffic.pop(ACCEPTED)
    assert readers.more_is_expected()
    readers.accept(accepted.link)
    assert not readers.more_is_expected()


def test_nothing_of_its_own_is_expected_once_a_way_to_receive_is_not_counted(traffic, monkeypatch):
    waits_for(ACCEPTED, monkeypatch)
    traffic[CLIENT].sent = 7
    monkeypatch.setattr(readers, "counts_own", False)
    assert not readers.more_is_expected()
