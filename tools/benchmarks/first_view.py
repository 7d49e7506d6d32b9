"""Measure the first view of pages on a slow telephone with Lighthouse.

``python -m tools.benchmarks.first_view [page ...]``

Some pages that ``make book`` built are opened, from a server that compresses and from one that does
not. Lighthouse, which comes from npm, computes from a page's requests and tasks how a slow
telephone on a slow line would perform.

A task is weighted by its processor time, not by the time that passed: on a machine that does other
things as well, Lighthouse would count those against the page. So its recording is corrected first
and then judged. Only the speed index still depends on the time that passed: the busier the machine,
the worse it is.

Lighthouse takes a page as shown only when all of it has arrived. The last column but one gives the
time until the first view was seen in a browser on an equally slow line: the median of three.
"""

import bisect
import gzip
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
from collections import defaultdict
from pathlib import Path

from notebook_pages.browser import find, open_browser
from notebook_pages.paths import NODE
from notebook_pages.serve import Handler, server
from notebook_pages.set_up import npm

SITE, SCRATCH = Path("_build/html"), Path("_build/benchmark/lighthouse")
LIGHTHOUSE = "lighthouse@12.8.2"
PAGES = (
    "index",
    "chapters/euler-angles",
    "chapters/simple-orientations",
    "appendix/solutions",
    "exercises/euler-angles",
)
MEASURES = {
    "first-contentful-paint": ("first paint", 1000, "s"),
    "largest-contentful-paint": ("largest paint", 1000, "s"),
    "speed-index": ("speed index", 1000, "s"),
    "total-blocking-time": ("blocking", 1, "ms"),
    "cumulative-layout-shift": ("shift", 1, ""),
}
CATEGORIES = ("performance", "accessibility", "best-practices", "seo")
PACKED = {".html", ".css", ".js", ".svg", ".json", ".webmanifest"}


class Compressing(Handler):
    """A server of the site that compresses files as real servers do."""

    protocol_version = "HTTP/1.1"

    def do_GET(self):
        path = Path(self.translate_path(self.path))
        if path.suffix not in PACKED or not path.is_file():
            super().do_GET()
            return
        content = gzip.compress(path.read_bytes(), 6)
        self.send_response(200)
        for name, value in (
            ("Type", self.guess_type(path)),
            ("Encoding", "gzip"),
            ("Length", len(content)),
        ):
            self.send_header(f"Content-{name}", str(value))
        self.end_headers()
        self.wfile.write(content)


def serve(handler):
    """Serve the built site, and return its address."""
    if find() is None:
        sys.exit("There is no Chromium on this machine to open the pages with.")
    if not (SITE / "index.html").is_file():
        sys.exit("The book is not built: run `make book` first.")
    book = server(folder=SITE, handler=handler)
    threading.Thread(target=book.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{book.server_port}"


def program():
    """Return Lighthouse's own program, and fetch it if necessary."""
    path = SCRATCH / "node_modules" / "lighthouse" / "cli" / "index.js"
    if not path.is_file():
        SCRATCH.mkdir(parents=True, exist_ok=True)
        npm("install", "--ignore-scripts", "--no-audit", "--no-fund", LIGHTHOUSE, cwd=SCRATCH)
    return path


def by_processor_time(trace):
    """Give each task of a trace its processor time, and scale the events in it accordingly."""
    threads = defaultdict(list)
    for event in trace["traceEvents"]:
        threads[event.get("pid"), event.get("tid")].append(event)
    for events in threads.values():
        tasks = [
            event
            for event in events
            if event["name"].endswith("RunTask") and event.get("dur") and "tdur" in event
        ]
        starts, lengths, shares, end = [], [], [], 0
        for task in sorted(tasks, key=lambda task: (task["ts"], -task["dur"])):
            if task["ts"] >= end:  # a task within another does not count
                starts.append(task["ts"])
                lengths.append(task["dur"])
                shares.append(min(1, max(task["tdur"], 1) / task["dur"]))
                end = task["ts"] + task["dur"]

        def moved(moment, starts=starts, lengths=lengths, shares=shares):
            place = bisect.bisect_right(starts, moment) - 1
            if place < 0 or moment > starts[place] + lengths[place]:
                return moment
            return int(starts[place] + (moment - starts[place]) * shares[place])

        for event in events:
            if event.get("ph") == "X":
                begin, end = moved(event["ts"]), moved(event["ts"] + event["dur"])
                event["ts"], event["dur"] = begin, max(0, end - begin)
            elif event.get("ph") in ("B", "E"):
                event["ts"] = moved(event["ts"])


def judge(lighthouse, address):
    """Return Lighthouse's report on the page at ``address``."""
    environment = os.environ | {"CHROME_PATH": shutil.which("chromium") or find()}
    with tempfile.TemporaryDirectory() as folder:
        command = [NODE, lighthouse, address, "--quiet"]
        browser = "--chrome-flags=--headless=new --no-sandbox"
        subprocess.run(
            [*command, f"-G={folder}", browser], check=True, env=environment, capture_output=True
        )
        [recorded] = Path(folder).glob("*.trace.json")
        trace = json.loads(recorded.read_text("utf8"))
        by_processor_time(trace)
        recorded.write_text(json.dumps(trace), "utf8")
        out = Path(folder, "out.json")
        options = [f"-A={folder}", "--output=json", f"--output-path={out}"]
        subprocess.run([*command, *options], check=True, env=environment, capture_output=True)
        return json.loads(out.read_text("utf8"))


# Lighthouse's slow line: the round-trip time, and bytes a second.
SLOW = {
    "offline": False,
    "latency": 150,
    "downloadThroughput": 1_474_560 / 8,
    "uploadThroughput": 675_000 / 8,
}
SEEN = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime"


def seen_on_a_slow_line(browser, address):
    """Measure the seconds until a telephone's screen shows the first view of ``address``."""
    context = browser.new_context(
        viewport={"width": 412, "height": 823}, device_scale_factor=1.75, is_mobile=True
    )
    page = context.new_page()
    line = context.new_cdp_session(page)
    line.send("Network.enable")
    line.send("Network.emulateNetworkConditions", SLOW)
    page.goto(address)
    # A busy machine paints only after everything has arrived.
    seconds = page.wait_for_function(SEEN).json_value() / 1000
    context.close()
    return seconds


def main():
    lighthouse = program()
    print(
        "| page | server |",
        " | ".join([*CATEGORIES, *(name for name, _, _ in MEASURES.values())]),
        "| seen | load |",
    )
    print("|---" * (len(CATEGORIES) + len(MEASURES) + 4) + "|")
    for kind, handler in (("compressing", Compressing), ("plain", Handler)):
        book = serve(handler)
        for page in sys.argv[1:] or PAGES:
            load = os.getloadavg()[0]
            address = f"{book}/{page}.html"
            with open_browser() as browser:
                seen = statistics.median(seen_on_a_slow_line(browser, address) for _ in range(3))
            report = judge(lighthouse, address)
            scores = [f"{100 * report['categories'][name]['score']:.0f}" for name in CATEGORIES]
            numbers = [
                f"{report['audits'][name]['numericValue'] / divisor:.3g} {unit}".strip()
                for name, (_, divisor, unit) in MEASURES.items()
            ]
            print(
                f"| {page} | {kind} |",
                " | ".join([*scores, *numbers]),
                f"| {seen:.2f} s | {load:.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
