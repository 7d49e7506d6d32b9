"""Other engines than Chromium: Firefox by WebDriver BiDi, WebKitGTK by WebDriver.

Each has the same small interface: ``go`` to an address, ``run`` a function in the page, ``wait``
for a condition.
"""

import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path

import pytest
from places import BROWSER_REQUIRED

PATIENCE = 600  # seconds, for a busy machine; nothing waits longer than it must
ENTER = "\ue007"  # as WebDriver writes this key


def absent(reason):
    pytest.fail(reason) if BROWSER_REQUIRED else pytest.skip(reason)


def free_port():
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        return bound.getsockname()[1]


class Engine:
    """The common part of all engines.

    The keyboard and the pointer are those of WebDriver: ``perform`` gets their actions.
    """

    def click(self, x, y):
        place = {"type": "pointerMove", "x": round(x), "y": round(y)}
        press = [{"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp")]
        self.perform({"type": "pointer", "id": "mouse", "actions": [place, *press]})

    def type(self, text):
        keys = text.replace("\n", ENTER)
        strokes = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.perform({"type": "key", "id": "keyboard", "actions": strokes})

    def wait(self, function, *arguments):
        """Wait until ``function``, in the page, returns a true value, and return it."""
        end = time.monotonic() + PATIENCE
        while not (result := self.run(function, *arguments)):
            assert time.monotonic() < end, f"after {PATIENCE} s still not so: {function}"
            time.sleep(0.1)
        return result


class Chromium(Engine):
    """A page of the browser that the other tests use."""

    def __init__(self, browser):
        self.page = browser.new_context(viewport={"width": 1300, "height": 900}).new_page()

    def go(self, address):
        self.page.goto(address)

    def click(self, x, y):
        self.page.mouse.click(x, y)

    def type(self, text):
        self.page.keyboard.type(text)

    def run(self, function, *arguments):
        return self.page.evaluate(f"(given) => ({function})(...given)", list(arguments))

    def close(self):
        self.page.context.close()


class Firefox(Engine):
    def __init__(self):
        import websocket

        program = shutil.which("firefox-esr") or shutil.which("firefox")
        if program is None:
            absent("Firefox is not on this machine (on Debian: sudo apt install firefox-esr)")
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        port = free_port()
        # These settings prevent requests to its makers.
        settings = {
            "app.normandy.enabled": False,
            "browser.safebrowsing.malware.enabled": False,
            "browser.safebrowsing.phishing.enabled": False,
            "datareporting.policy.dataSubmissionEnabled": False,
            "network.captive-portal-service.enabled": False,
            "services.settings.server": "data:,",
            "remote.prefs.recommended": True,
        }
        lines = [
            f"user_pref({json.dumps(name)}, {json.dumps(value)});"
            for name, value in settings.items()
        ]
        Path(self.folder.name, "user.js").write_text("\n".join(lines))
        command = [
            program,
            "--headless",
            "--no-remote",
            "--profile",
            self.folder.name,
            "--remote-debugging-port",
            str(port),
        ]
        self.process = subprocess.Popen(
            command,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "HOME": self.folder.name},
        )
        end = time.monotonic() + PATIENCE
        while True:
            try:
                self.socket = websocket.create_connection(
                    f"ws://127.0.0.1:{port}/session", timeout=PATIENCE, suppress_origin=True
                )
                break
            except OSError:
                assert time.monotonic() < end and self.process.poll() is None, (
                    "Firefox does not listen"
                )
                time.sleep(0.1)
        self.number = 0
        self.version = self.send("session.new", capabilities={})["capabilities"]["browserVersion"]
        self.context = self.send("browsingContext.getTree")["contexts"][0]["context"]
        self.send(
            "browsingContext.setViewport",
            context=self.context,
            viewport={"width": 1300, "height": 900},
        )

    def send(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self.socket.recv())
            if answer.get("id") == self.number:
                assert answer["type"] == "success", answer
                return answer["result"]

    def go(self, address):
        self.send("browsingContext.navigate", context=self.context, url=address, wait="complete")

    def run(self, function, *arguments):
        answer = self.send(
            "script.callFunction",
            functionDeclaration="async (text) => JSON.stringify((await "
                f"({function})(...JSON.parse(text))) ?? null)",
            arguments=[{"type": "string", "value": json.dumps(arguments)}],
            target={"context": self.context}, awaitPromise=True,
        )  # fmt: skip
        assert answer["type"] == "success", answer["exceptionDetails"]["text"]
        return json.loads(answer["result"]["value"])

    def perform(self, source):
        self.send("input.performActions", context=self.context, actions=[source])

    def close(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait()
        self.folder.cleanup()


class WebKit(Engine):
    def __init__(self):
        driver = shutil.which("WebKitWebDriver")
        screen = shutil.which("Xvfb")
        if driver is None or screen is None:
            absent(
                "WebKit is not on this machine (on Debian: sudo apt install webkit2gtk-driver xvfb)"
            )
        (browser,) = list(Path("/usr/lib").glob("*/webkit2gtk-4.?/MiniBrowser"))[:1] or [None]
        if browser is None:
            absent(
                "WebKit's MiniBrowser is not on this machine (on Debian: sudo apt install "
                "webkit2gtk-driver)"
            )
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        reading, writing = os.pipe()
        self.screen = subprocess.Popen(
            [screen, "-displayfd", str(writing), "-screen", "0", "1300x900x24", "-nolisten", "tcp"],
            pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(writing)
        with os.fdopen(reading) as pipe:
            display = pipe.readline().strip()
        port = free_port()
        environment = {
            **os.environ, "DISPLAY": f":{display}", "HOME": self.folder.name,
            "XDG_RUNTIME_DIR": self.folder.name, "WEBKIT_DISABLE_COMPOSITING_MODE": "1",
            "WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS": "1", "GDK_BACKEND": "x11",
            "NO_AT_BRIDGE": "1", "LIBGL_ALWAYS_SOFTWARE": "1",
            # Safari gives shared memory to isolated pages; this build of its engine does so on
            # request.
            "JSC_useSharedArrayBuffer": "1",
        }  # fmt: skip
        environment.pop("WAYLAND_DISPLAY", None)
        self.process = subprocess.Popen(
            [driver, f"--port={port}", "--host=127.0.0.1"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment,
        )  # fmt: skip
        self.address = f"http://127.0.0.1:{port}/session"
        options = {"binary": str(browser), "args": ["--automation"]}
        capabilities = {"capabilities": {"alwaysMatch": {"webkitgtk:browserOptions": options}}}
        end = time.monotonic() + PATIENCE
        while True:
            try:
                session = self.send("", capabilities)
                break
            except ConnectionError:
                assert time.monotonic() < end and self.process.poll() is None, (
                    "WebKit's driver does not listen"
                )
                time.sleep(0.1)
        self.version = session["capabilities"]["browserVersion"]
        self.address += f"/{session['sessionId']}"
        self.send("/timeouts", {"script": PATIENCE * 1000, "pageLoad": PATIENCE * 1000})

    def send(self, path, content):
        request = urllib.request.Request(
            self.address + path, json.dumps(content).encode(), {"Content-Type": "application/json"}
        )
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            with error:
                raise AssertionError(error.read().decode()[:2000]) from None
        except urllib.error.URLError as error:
            if isinstance(error.reason, ConnectionError):
                raise error.reason from None
            raise

    def go(self, address):
        self.send("/url", {"url": address})

    def run(self, function, *arguments):
        script = (
            "const done = arguments[arguments.length - 1];"
            f"Promise.resolve(({function})(...JSON.parse(arguments[0]))).then("
            "(value) => done(JSON.stringify({ value: value ?? null })),"
            "(error) => done(JSON.stringify({ error: String(error) })));"
        )
        answer = json.loads(
            self.send("/execute/async", {"script": script, "args": [json.dumps(arguments)]})
        )
        assert "error" not in answer, answer["error"]
        return answer["value"]

    def perform(self, source):
        self.send("/actions", {"actions": [source]})

    def close(self):
        try:
            urllib.request.urlopen(
                urllib.request.Request(self.address, method="DELETE"), timeout=20
            ).close()
        except OSError:
            pass  # it has ended already
        for process in (self.process, self.screen):
            process.terminate()
            process.wait()
        self.folder.cleanup()


ENGINES = {"Firefox": Firefox, "WebKit": WebKit}
