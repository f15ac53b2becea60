"""A headless Chromium, driven through its DevTools pipe; needs nothing but the browser itself."""

import base64
import contextlib
import io
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def find():
    """Return the path of a browser, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One page. ``errors`` gathers complaints of its console, ``requests`` every address it asked for."""

    def __init__(self, path, size=(1100, 760)):
        self.errors, self.requests = [], []
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        # The browser reads descriptor 3 and writes 4; named pipes spare games with numbers.
        ask, answer = (Path(self._folder.name) / name for name in ("ask", "answer"))
        os.mkfifo(ask)
        os.mkfifo(answer)
        command = [
            "sh",
            "-c",
            f'exec "$0" "$@" 3<"{ask}" 4>"{answer}"',
            path,
            "--headless=new",
            "--no-sandbox",
            "--remote-debugging-pipe",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--disable-dev-shm-usage",
            "--no-first-run",
            f"--window-size={size[0]},{size[1]}",
            f"--user-data-dir={self._folder.name}",
            "about:blank",
        ]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._out = ask.open("wb", buffering=0)
        self._in = answer.open("rb", buffering=0)
        self._number, self._left = 0, b""
        target = self.call("Target.createTarget", url="about:blank")
        answer = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self._session = answer["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    _session = None

    def call(self, method, **parameters):
        """Ask the browser for something."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._out.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]
            self._note(answer)

    def _next(self):
        while b"\0" not in self._left:
            data = self._in.read(1 << 16)
            assert data, "the browser ended"
            self._left += data
        text, _, self._left = self._left.partition(b"\0")
        return json.loads(text)

    def _note(self, event):
        kind, facts = event.get("method"), event.get("params", {})
        if kind == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(facts["exceptionDetails"]))
        elif kind == "Runtime.consoleAPICalled" and facts["type"] in ("error", "warning", "assert"):
            self.errors.append(json.dumps(facts["args"]))
        elif kind == "Log.entryAdded" and facts["entry"]["level"] == "error":
            self.errors.append(facts["entry"]["text"])
        elif kind == "Network.requestWillBeSent":
            self.requests.append(facts["request"]["url"])

    def open(self, path):
        """Open a file and wait until it is loaded."""
        self.call("Page.navigate", url=path.resolve().as_uri())
        deadline = time.monotonic() + 30
        while self.run("document.readyState") != "complete" or self.run("location.href") == "about:blank":
            assert time.monotonic() < deadline, "the page does not load"
            time.sleep(0.05)

    def run(self, script):
        """Evaluate an expression on the page."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def drag(self, start, end, button="left", modifiers=0):
        """Drag the mouse."""
        common = {"button": button, "clickCount": 1, "modifiers": modifiers}
        held = {"left": 1, "right": 2, "middle": 4}[button]
        self.call(
            "Input.dispatchMouseEvent", type="mousePressed", x=start[0], y=start[1], buttons=held, **common
        )
        for k in range(1, 5):
            x, y = (a + (b - a) * k / 4 for a, b in zip(start, end, strict=True))
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, buttons=held, **common)
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=end[0], y=end[1], buttons=0, **common)

    def wheel(self, at, delta):
        """Turn the wheel."""
        self.call("Input.dispatchMouseEvent", type="mouseWheel", x=at[0], y=at[1], deltaX=0, deltaY=delta)

    def picture(self):
        """Take a picture, (height, width, 3) from 0 to 1, and its bytes."""
        from matplotlib.image import imread

        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        return imread(io.BytesIO(data))[:, :, :3], data

    def close(self):
        """End the browser."""
        with contextlib.suppress(OSError):
            self._out.close()
        self._process.kill()
        self._process.wait()
        self._in.close()
        self._folder.cleanup()
