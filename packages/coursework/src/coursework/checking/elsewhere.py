"""Sealed variants that lie where the pages lie: only a browser's
Python asks for them, one by one.
"""

from importlib.resources.abc import Traversable


def fetched(file: Traversable, name: str) -> str:
    """A file from where the pages lie, whose address follows upon that of Python's packages."""
    import js
    import pyodide_js

    address = f"{pyodide_js.lockfileBaseUrl}{file.read_text('utf8')}{name}"
    request = js.XMLHttpRequest.new()
    try:
        request.open("GET", address, False)
        request.send()
        if request.status == 200:
            return str(request.responseText)
        why = f"the server says {request.status}"
    except Exception as error:  # what the browser throws where there is no network
        why = str(error)
    raise RuntimeError(
        f"Your numbers could not be fetched from {address} ({why}). Is there a network?"
    )
