"""For tests that seal questions themselves: nobody tries their keys, so these need not be slow."""

import pytest

from coursework.checking import sealing


@pytest.fixture(autouse=True, scope="module")
def keys_are_quick():
    """A key of as many rounds as those of a released question is most of what such tests cost.

    Whoever imports this has it; not for what is sealed or opened in another process.
    """
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sealing, "ROUNDS", 2)
        yield
