"""A real browser, where there is one."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[..., Browser]]:
    """Starts Chromium with more command-line arguments."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no Chromium is installed: apt-get install chromium")
    with sync_playwright() as playwright:
        yield lambda *arguments: playwright.chromium.launch(executable_path=found, args=["--no-sandbox", *arguments])


@pytest.fixture(scope="session")
def browser(launch: Callable[..., Browser]) -> Iterator[Browser]:
    # software rendering, so that WebGL is there also without a graphics card
    browser = launch("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
    yield browser
    browser.close()


@pytest.fixture
def open_page(browser: Browser, request: pytest.FixtureRequest) -> Iterator[Callable[..., Page]]:
    """Opens a file as a reader does; a complaint in the console or a request to anywhere else fails the test.

    Screenshots lie in ``.pytest_cache/d/screenshots`` afterwards.
    """
    complaints: list[str] = []
    pages: list[Page] = []
    screenshots = request.config.cache.mkdir("screenshots")

    def open_file(path: Path, **options) -> Page:
        page = browser.new_page(**{"viewport": {"width": 1280, "height": 900}, **options})
        page.on("console", lambda message: complaints.append(f"console: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
        page.on("request", lambda request: _check(request.url, path, complaints))
        page.goto(path.as_uri())
        pages.append(page)
        return page

    yield open_file
    for number, page in enumerate(pages):
        page.screenshot(path=screenshots / f"{request.node.name}-{number}.png")
        page.close()
    assert not complaints


def _check(url: str, path: Path, complaints: list[str]) -> None:
    if not url.startswith((path.parent.as_uri(), "data:", "blob:")):
        complaints.append(f"request: {url}")
