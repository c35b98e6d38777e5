"""Chromium without a window, for pages of tests; `make browser` installs what drives it."""

import contextlib
import shutil

import pytest

#: Names that the browser goes by.
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@contextlib.contextmanager
def chromium():
    """A running browser.

    The test is skipped where there is none, or nothing to drive it.
    """
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed, which drives the browser: run `make browser`"
    )
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("there is no Chromium on this machine: install it, such as by `apt-get install chromium`")
    with playwright.sync_playwright() as driver:
        # Without a window and as whoever runs the tests, which may be root in a container.
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


class Explorer:
    """An opened page, with what it asked the network for and said to the console."""

    def __init__(self, browser, file, **options):
        self.page = browser.new_page(**options)
        self.requests, self.complaints = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.goto(file.as_uri())
        self.page.wait_for_function("window.explorer")
        #: From the beginning of the navigation to a page that answers [ms].
        self.loading = self.page.evaluate("performance.now()")

    @property
    def told(self) -> str:
        """The text on the picked point."""
        return self.page.inner_text("#picked")

    def choose(self, mode: str, direction: int) -> None:
        """Choose a mode and a direction by the controls."""
        self.page.check(f"#modes input[value={mode}]")
        self.page.locator("#direction").fill(str(direction))

    def click(self, x: float, y: float) -> float:
        """Click on a position of the sheet; returns the time until the curve is drawn [ms]."""
        return self.page.evaluate(
            """([x, y]) => {
                const sheet = document.getElementById("sheet"), box = sheet.getBoundingClientRect();
                const [, , width, height] = sheet.getAttribute("viewBox").split(" ").map(Number);
                const frame = sheet.querySelector("rect.axis");
                const at = (name) => Number(frame.getAttribute(name));
                const clientX = box.left + (at("x") + x * at("width")) / width * box.width;
                const clientY = box.top + (at("y") + (1 - y) * at("height")) / height * box.height;
                const begin = performance.now();
                sheet.dispatchEvent(new MouseEvent("click", { clientX, clientY, bubbles: true }));
                document.getElementById("chart").getBoundingClientRect();
                return performance.now() - begin;
            }""",
            [x, y],
        )

    def download(self, button: str) -> bytes:
        """What a button saves."""
        with self.page.expect_download() as waiting:
            self.page.click(button)
        with open(waiting.value.path(), "rb") as file:
            return file.read()
