"""The last pass over the built pages, for what can be written only when everything is there.

- The address of each script and style carries a version, a hash of its content, so that no cache
  mixes old scripts with new pages.
- Each page states its Content-Security-Policy: what the browser may load, and from where.
- Pages with code say how large the download of Python is.
- Indentation is removed outside code, which saves two kilobytes of a chapter.
"""

import base64
import json
import posixpath
import re
from functools import cache
from hashlib import sha256
from pathlib import Path

from .live.runtime import FOLDER, LOCK

VERSIONED = re.compile(
    r'(<(?:script|link)\b[^>]*?\s(?:src|href)=")([^"?#:]+\.(?:js|css|svg|png|webmanifest))(?:\?v=\w*)?"'
)
INLINE = re.compile(r"<script(?: [^>]*)?>(.*?)</script>", re.DOTALL)
# Match code and text areas, which keep their white space, or else the indentation of a line.
INDENTED = re.compile(r"(<(pre|textarea)\b.*?</\2>)|\n\s+", re.DOTALL)
CHARSET = re.compile(
    r'(<meta charset="utf-8" ?/?>)(?:<meta http-equiv="Content-Security-Policy"[^>]*>)?'
)
# Allow styles in the HTML because KaTeX and the drawings place their parts with them. Allow only
# the scripts that the build has written, each by its hash. `blob:` is for results of cells that the
# reader has run.
POLICY = {
    "default-src": "'self'",
    "script-src": "'self' 'wasm-unsafe-eval' blob:",
    "style-src": "'self' 'unsafe-inline'",
    "img-src": "'self' data: blob:",
    "font-src": "'self' data:",
    "connect-src": "'self' blob:",
    "worker-src": "'self'",
    "object-src": "'none'",
    "base-uri": "'self'",
    "form-action": "'self'",
}


def pages_of(site):
    """Return the pages of the book in ``site``, without notebooks."""
    return [
        path for path in sorted(site.rglob("*.html")) if path.relative_to(site).parts[0] != "lite"
    ]


def policy(text, elsewhere):
    """Return the policy of the page ``text``, whose Python may fetch from ``elsewhere``."""
    digests = {
        base64.b64encode(sha256(script[1].encode()).digest()).decode()
        for script in INLINE.finditer(text)
        if not re.search('src=|type="application/', script[0].partition(">")[0])
    }
    more = {
        "connect-src": elsewhere,
        "script-src": [f"'sha256-{digest}'" for digest in sorted(digests)],
    }
    return "; ".join(" ".join([name, POLICY[name], *more.get(name, [])]) for name in POLICY)


def write(site):
    @cache
    def version(path):
        return sha256(path.read_bytes()).hexdigest()[:8] if path.is_file() else None

    (listed,) = (site / FOLDER).glob(f"lock-*/{LOCK}")
    lock = json.loads(listed.read_text("utf8"))
    variants = " ".join(sorted(folder.name for folder in (site / FOLDER).glob("sealed-*")))
    elsewhere = sorted(
        {
            "/".join(package["file_name"].split("/")[:3])
            for package in lock["packages"].values()
            if "://" in package["file_name"]
        }
    )
    for page in pages_of(site):
        before = page.read_text("utf8")

        def with_version(match, folder=page.parent):
            fingerprint = version(Path(posixpath.normpath(folder / match[2])))
            return f'{match[1]}{match[2]}?v={fingerprint}"' if fingerprint else match[0]

        text = VERSIONED.sub(with_version, before)
        text = INDENTED.sub(lambda match: match[1] or "\n", text)
        text = re.sub(r'("bytes":)\d+', rf"\g<1>{lock['bytes']}", text)
        text = re.sub(r'("lock":")[^"]*', rf"\g<1>{listed.parent.name}/", text)
        text = re.sub(r'("variants":")[^"]*', rf"\g<1>{variants}", text)
        rules = f'<meta http-equiv="Content-Security-Policy" content="{policy(text, elsewhere)}">'
        text, count = CHARSET.subn(lambda match: match[1] + rules, text)
        if count != 1:
            raise RuntimeError(f"{page} must declare its encoding once, not {count} times")
        if text != before:
            page.write_text(text, "utf8")


def finish(app, exception):
    if not exception and app.builder.format == "html":
        write(Path(app.outdir))


def setup(app):
    # Run this after all others.
    app.connect("build-finished", finish, priority=990)
