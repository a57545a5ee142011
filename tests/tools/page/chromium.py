"""Headless Chromium, controlled through a pipe (Chrome DevTools Protocol).

One browser for many pages, sizes and themes.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

LIMIT_S = 120  # for one answer
DRAWN = """!document.querySelector('#page > .wait') && (!document.querySelector('main') || document.querySelector('main').children.length > 0) &&
    !(location.hash.startsWith('#trial-') && !document.querySelector('.grid .chart'))"""


def program():
    """Returns the browser's path."""
    found = [
        path
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (path := shutil.which(name))
    ]
    if not found:
        raise FileNotFoundError("no Chromium here; get it with: tools/setup/setup.sh test")
    return found[0]


class Chromium:
    """One browser tab with its own profile: `with Chromium() as browser: ...`."""

    def __enter__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.commands = os.pipe()
        self.answers, from_browser = os.pipe()
        # The browser reads commands from descriptor 3 and writes answers to 4.
        self.process = subprocess.Popen(
            [
                "sh",
                "-c",
                f'exec "$@" 3<&{to_browser} 4>&{from_browser}',
                "sh",
                program(),
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--hide-scrollbars",
                "--remote-debugging-pipe",
                f"--user-data-dir={self.profile.name}",
            ],
            pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.buffer, self.events, self.session = 0, b"", [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)[
            "sessionId"
        ]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        return self

    def __exit__(self, *_):
        os.close(self.commands)  # which ends the browser
        self.process.wait(LIMIT_S)
        os.close(self.answers)
        self.profile.cleanup()

    def _message(self, end):
        while b"\0" not in self.buffer:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.answers], [], [], left)[0]:
                raise TimeoutError("Chromium does not answer")
            chunk = os.read(self.answers, 1 << 20)
            if not chunk:
                raise RuntimeError("Chromium has ended")
            self.buffer += chunk
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        """Returns the result of a command. Events that arrive meanwhile are kept."""
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.commands, json.dumps(command).encode() + b"\0")
        end = time.monotonic() + LIMIT_S
        while True:
            message = self._message(end)
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            self.events.append(message)

    def wait_for(self, event):
        """Waits for `event`."""
        end = time.monotonic() + LIMIT_S
        while not any(seen.get("method") == event for seen in self.events):
            self.events.append(self._message(end))

    def look(self, width, height=1000, dark=False):
        """Sets the window size [px] and the reader's theme for the open page and later ones."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.call(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}],
        )

    def open(self, page, fragment=""):
        """Opens a file from a blank page and waits until it is loaded."""
        for url in ("about:blank", Path(page).resolve().as_uri() + fragment):
            self.events.clear()
            self.call("Page.navigate", url=url)
            self.wait_for("Page.loadEventFired")

    def open_drawn(self, page, fragment=""):
        """Opens a report and waits until it is drawn.

        The last charts of a trial are those of its units.
        """
        self.open(page, fragment)
        end = time.monotonic() + LIMIT_S
        while not self.evaluate(DRAWN):
            if time.monotonic() > end:
                raise TimeoutError(f"{page}{fragment} is not drawn: {self.complaints()}")
            time.sleep(0.02)

    def dom(self):
        """Returns the current page as HTML."""
        return self.evaluate("document.documentElement.outerHTML")

    def evaluate(self, expression):
        """Returns the value of a JavaScript expression in the page; it may be a promise."""
        found = self.call(
            "Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in found:
            details = found["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return found["result"].get("value")

    def complaints(self):
        """Returns the console's errors since the page was opened.

        Exceptions, policy refusals, missing files.
        """
        self.evaluate("0")  # earlier events have arrived by now
        found = []
        for event in self.events:
            parameters = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                details = parameters["exceptionDetails"]
                found.append(details.get("exception", {}).get("description", details["text"]))
            elif event.get("method") == "Runtime.consoleAPICalled" and parameters["type"] in (
                "error",
                "warning",
                "assert",
            ):
                found.append(
                    " ".join(
                        str(argument.get("value", argument.get("description")))
                        for argument in parameters["args"]
                    )
                )
            elif event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] in (
                "error",
                "warning",
            ):
                found.append(parameters["entry"]["text"])
        return found

    def screenshot(self, whole=True):
        """Returns the page as PNG bytes; `whole` includes the part below the window."""
        return base64.b64decode(
            self.call(
                "Page.captureScreenshot",
                format="png",
                captureBeyondViewport=whole,
                **({"clip": self._whole_page()} if whole else {}),
            )["data"]
        )

    def _whole_page(self):
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        return {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
