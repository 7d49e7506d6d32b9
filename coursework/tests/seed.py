"""What is drawn by lot in this run is drawn from this: another day draws another lot, and the same seed the same."""

import datetime
import os

SEED = os.environ.setdefault("BOOK_TEST_SEED", datetime.date.today().isoformat())
