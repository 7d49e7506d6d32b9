"""Quick keys for tests that seal questions themselves, which nobody tries to open."""

import pytest

from coursework.checking import sealing


@pytest.fixture(autouse=True, scope="module")
def keys_are_quick():
    """Use few rounds for keys, which would otherwise take most of the time of such tests.

    Importing this is enough. It does not affect what another process seals or opens.
    """
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sealing, "ROUNDS", 2)
        yield
