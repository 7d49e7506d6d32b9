"""Tools for authors: questions from notebooks with solutions, their release and their self-test."""

import sys

# With this optional package, jsonschema (and so nbformat) takes two seconds to import: it builds 38
# parsers of international addresses, which nothing here needs.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
