"""Real scans lie beside the checkout; tests that need them skip where they are absent."""

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared_data() -> Path:
    folder = Path(__file__).resolve().parents[3] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the real scans (../shared/data beside the checkout) are not on this machine")
    return folder
