"""The lab's steps as a list to tick off beside the robot."""

from typing import Any

from ...web import text
from ...web.elements import Html
from ...web.lab import Section, read_lab
from .part import Context, Part

DONE = "✓ "


class Lab(Part):
    """One folder for each section of docs/lab.md; all browsers share the ticks."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        for section in read_lab():
            self._add(section)

    def _add(self, section: Section) -> None:
        gui = self.context.server.gui
        with gui.add_folder(section.title, expand_by_default=False) as folder:
            Html(gui).show(text.steps(section))
            done = gui.add_checkbox("Done", False)

        async def on_update(_: Any) -> None:
            folder.label = f"{DONE}{section.title}" if done.value else section.title

        done.on_update(on_update)
