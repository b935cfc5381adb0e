"""Headless Chromium through its own DevTools pipe: no driver, no package, no port.

Commands go to the browser's file descriptor 3 and answers come from 4, as JSON that ends in a zero.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
)
PATIENCE = 60.0
"""Seconds for one answer; a loaded machine draws 3D in software."""


def found() -> str | None:
    return shutil.which("chromium") or shutil.which("/usr/bin/chromium")


class Tab:
    """One page; `problems` collects console errors, exceptions and requests."""

    def __init__(self, to: int, out: int):
        self.to, self.out, self.rest, self.count = to, out, b"", 0
        self.session: str | None = None
        self.problems: list[str] = []
        self.requests: list[str] = []

    def send(self, method: str, **params: Any) -> dict[str, Any]:
        """Run one command; what happens meanwhile is noted."""
        self.count += 1
        message: dict[str, Any] = {"id": self.count, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        self._write(json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._read(end)
            if answer.get("id") == self.count:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]
            self._note(answer)

    def _write(self, data: bytes) -> None:
        while data:
            data = data[os.write(self.to, data) :]

    def _read(self, end: float) -> dict[str, Any]:
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.out], [], [], max(end - time.monotonic(), 0))
            assert ready, f"Chromium gave no answer in {PATIENCE} s"
            more = os.read(self.out, 1 << 20)
            assert more, "Chromium ended"
            self.rest += more
        line, self.rest = self.rest.split(b"\0", 1)
        return json.loads(line)

    def _note(self, event: dict[str, Any]) -> None:
        what, said = event.get("method", ""), event.get("params", {})
        if what == "Network.requestWillBeSent":
            self.requests.append(said["request"]["url"])
        elif what == "Runtime.exceptionThrown":
            self.problems.append(str(said["exceptionDetails"]))
        elif what == "Runtime.consoleAPICalled" and said["type"] in ("error", "warning"):
            self.problems.append(" ".join(str(a.get("value")) for a in said["args"]))
        elif what == "Log.entryAdded" and said["entry"]["level"] == "error":
            self.problems.append(said["entry"]["text"])

    # -- what tests do ----------------------------------------------------------------------------

    def look(self, width: int, height: int = 900, dark: bool = False) -> None:
        """Size of the window, and the colours that the reader's system asks for."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", **size)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])

    def open(self, path: Path, ready: str) -> None:
        """Load a file with the network cut, and wait until an expression is true."""
        self.send("Page.navigate", url=path.resolve().as_uri())
        self.wait(ready)

    def run(self, expression: str) -> Any:
        result = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in result, result["exceptionDetails"]
        return result["result"].get("value")

    def wait(self, expression: str) -> None:
        end = time.monotonic() + PATIENCE
        while not self.run(expression):
            assert time.monotonic() < end, f"never true: {expression}; {self.problems}"
            time.sleep(0.05)

    def press(self, key: str, code: int) -> None:
        """A key of the keyboard, to the element that has the focus."""
        same = {"key": key, "code": key, "windowsVirtualKeyCode": code}
        self.send("Input.dispatchKeyEvent", type="keyDown", **same)
        self.send("Input.dispatchKeyEvent", type="keyUp", **same)

    def screenshot(self, path: Path) -> None:
        """The whole page, not only what the window shows."""
        height = self.run("document.documentElement.scrollHeight")
        width = self.run("innerWidth")
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        shot = self.send("Page.captureScreenshot", captureBeyondViewport=True, clip=clip)
        path.write_bytes(base64.b64decode(shot["data"]))


@contextmanager
def tab() -> Iterator[Tab]:
    """A browser with one empty page, its network cut."""
    command_out, command_in = os.pipe()
    answer_out, answer_in = os.pipe()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        # the shell puts the pipes where Chromium looks for them
        shell = f'exec "$0" "$@" 3<&{command_out} 4>&{answer_in}'
        browser = subprocess.Popen(
            ["/bin/bash", "-c", shell, str(found()), *FLAGS, f"--user-data-dir={profile}"],
            pass_fds=(command_out, answer_in),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        os.close(command_out)
        os.close(answer_in)
        try:
            made = Tab(command_in, answer_out)
            target = made.send("Target.createTarget", url="about:blank")["targetId"]
            attached = made.send("Target.attachToTarget", targetId=target, flatten=True)
            made.session = attached["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                made.send(f"{domain}.enable")
            offline = {"offline": True, "latency": 0}
            speed = {"downloadThroughput": -1, "uploadThroughput": -1}
            made.send("Network.emulateNetworkConditions", **offline, **speed)
            yield made
        finally:
            os.killpg(browser.pid, signal.SIGKILL)
            browser.wait()
            os.close(command_in)
            os.close(answer_out)
