"""What tests draw by lot they draw from this: the same every day, and another lot where it is set, as at night."""

import os

SEED = os.environ.setdefault("BOOK_TEST_SEED", "every day")
