"""Sealed variants on the server of the pages, which only a browser's Python requests."""

from importlib.resources.abc import Traversable


def fetched(file: Traversable, name: str) -> str:
    """Return a file from the server of the pages; its address is relative to Python's packages."""
    import js
    import pyodide_js

    address = f"{pyodide_js.lockfileBaseUrl}{file.read_text('utf8')}{name}"
    request = js.XMLHttpRequest.new()
    try:
        request.open("GET", address, False)
        request.send()
        if request.status == 200:
            return str(request.responseText)
        why = f"the server answered {request.status}"
    # Without a network, this is an error of the browser's.
    except Exception as error:
        why = str(error)
    raise RuntimeError(f"We could not fetch your numbers from {address} ({why}). Are you online?")
