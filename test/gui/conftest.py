"""What tests of pages share."""

import pytest
from browser import chromium


@pytest.fixture(scope="module")
def browser():
    """A browser; each test opens tabs of its own."""
    with chromium() as browser:
        yield browser
