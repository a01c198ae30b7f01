"""A real Chromium that shows the web page: clicks on the floor, on buttons and keys, texts, and errors it reports."""

import contextlib
import math
import os
import re
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright
from waiting import DEADLINE, wait_for

from aro_robocop_goto_as.web.page import FIELD, RIGHT, axes_of, corners_of, view_of

CHROMIUM = "/usr/bin/chromium"
# As root Chromium raises its own priority, and drawing in software it then takes a processor from everything else.
WITHOUT_PRIORITY = f"""#!/bin/sh
exec setpriv --bounding-set -sys_nice --inh-caps -sys_nice {CHROMIUM} "$@"
"""
# WebGL without a graphics card, and no connections of the browser's own.
FLAGS = (
    "--no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --disable-background-networking "
    "--disable-component-update --disable-sync --no-first-run --disable-quic --ignore-gpu-blocklist"
).split()
SIZE = (900, 620)  # [pixel]; software rendering takes as long as there are pixels


@contextlib.contextmanager
def chromium():
    """A browser without windows."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        program = Path(CHROMIUM)
        if os.geteuid() == 0:
            program = Path(folder) / "chromium"
            program.write_text(WITHOUT_PRIORITY)
            program.chmod(0o755)
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS, timeout=DEADLINE * 1000)
        try:
            yield browser
        finally:
            browser.close()


class Tab:
    """One tab with the web page, and everything that it complained about or asked other servers for."""

    def __init__(self, browser, url, size=SIZE, touch=False, density=1.0):
        self.url = url
        self.errors = []
        self.foreign = []
        viewport = {"width": size[0], "height": size[1]}
        self.page = browser.new_page(viewport=viewport, is_mobile=touch, has_touch=touch, device_scale_factor=density)
        self.page.set_default_timeout(DEADLINE * 1000)
        self.page.on("console", lambda message: message.type == "error" and self.errors.append(message.text))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self._note(request.url))
        self.sockets = 0  # that were opened, one for each connection or attempt
        self.page.on("websocket", self._note_socket)
        self.page.goto(url)

    def _note(self, url):
        if not url.startswith(("data:", "blob:")) and re.sub(r"^ws:", "http:", url).rstrip("/") != self.url:
            self.foreign.append(url)

    def _note_socket(self, socket):
        self.sockets += 1
        self._note(socket.url)

    def close(self):
        """Close the tab."""
        self.page.close()

    def text(self):
        """All text of the panel."""
        return self.page.inner_text("body")

    def wait_for_text(self, pattern, deadline=DEADLINE):
        """Wait until the panel's text matches a regular expression."""
        try:
            wait_for(lambda: re.search(pattern, self.text()), f"text {pattern!r} on the page", deadline)
        except AssertionError as error:
            raise AssertionError(f"{error}, which says:\n{self.text()}\nerrors: {self.errors}") from error

    def button(self, label):
        """A button of the panel; a hot key may follow its label."""
        return self.page.get_by_role("button", name=re.compile(rf"^{label}(\s\(\w\))?$"))

    def click(self, label):
        """Click a button once it stands still, and make sure that the click hit it."""
        self.button(label).click()

    def open(self, label):
        """Open a tab of the panel."""
        self.page.get_by_role("tab", name=label).click(force=True)

    def slider(self, label):
        """The slider of the row with this label."""
        find = """label => document.getElementById(
            [...document.querySelectorAll('label')].find(element => element.textContent === label).htmlFor
        ).querySelector('[role=slider]')"""
        return self.page.evaluate_handle(find, label).as_element()

    def choose(self, shown, wanted):
        """Choose another option of the drop-down list that shows this one."""
        find = "text => [...document.querySelectorAll('input')].find(input => input.value === text)"
        self.page.evaluate_handle(find, shown).as_element().click()
        self.page.get_by_role("option", name=wanted).click()

    def scene(self):
        """Width and height [pixel] of the scene, which begins in the window's upper left corner."""
        box = self.page.locator("canvas[data-engine]").bounding_box()
        return box["width"], box["height"]

    def pixels(self, points):
        """Where the first view shows points (n, 3) [m]: (n, 2) [pixel] from the left and from the top."""
        width, height = self.scene()
        aspect = width / height
        ahead, up = axes_of(aspect)
        away = np.asarray(points) - view_of(corners_of(()), aspect, (ahead, up), FIELD)[0]
        scale = height / 2.0 / math.tan(FIELD / 2.0) / (away @ ahead)
        return np.array((width, height)) / 2.0 + np.stack([scale * (away @ RIGHT), -scale * (away @ up)], axis=1)

    def pixel(self, x, y):
        """Where the first view shows a point of the floor [m]: columns from the left, rows from the top."""
        return self.pixels([(x, y, 0.0)])[0].tolist()

    def click_floor(self, x, y):
        """Click on a point of the floor [m], which nothing on the screen may cover."""
        self.page.mouse.click(*self.pixel(x, y))

    def tap(self, column, row):
        """Touch a pixel with a finger."""
        session = self.page.context.new_cdp_session(self.page)
        touch = "Input.dispatchTouchEvent"
        session.send(touch, {"type": "touchStart", "touchPoints": [{"x": column, "y": row}]})
        self.page.wait_for_timeout(50.0)
        session.send(touch, {"type": "touchEnd", "touchPoints": []})

    def turn(self, size):
        """Give the window another size [pixel], as turning a phone does."""
        self.page.set_viewport_size({"width": size[0], "height": size[1]})

    def covered(self, points):
        """Those of the points (n, 2) [pixel] at which something else than the scene is seen."""
        find = "([x, y]) => document.elementFromPoint(x, y)?.tagName"
        return [point for point in points.tolist() if self.page.evaluate(find, point) != "CANVAS"]

    @contextlib.contextmanager
    def held(self, label):
        """Hold a button with the mouse during the block."""
        self.button(label).scroll_into_view_if_needed()
        box = self.button(label).bounding_box()
        self.page.mouse.move(box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0)
        self.page.mouse.down()
        try:
            yield
        finally:
            self.page.mouse.up()
