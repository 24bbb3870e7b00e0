"""The page as a file: its data as JSON, a script that shows them, and nothing that comes from elsewhere."""

from __future__ import annotations

import base64
import hashlib
import json
from html import escape
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import Any

from swarm.errors import UserError
from swarm.files import printable, write_text

SCRIPTS = ("elements.js", "chart.js", "paths.js", "learning.js", "page.js")
"""In the order in which they build on each other."""
LARGEST_BYTES = 10_000_000
"""Of a page that is handed round by mail."""
DATA = "data"
"""The id of the element that holds the numbers."""

_SHELL = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<noscript><p>This page shows its numbers by a script: it needs JavaScript, and no network.</p></noscript>
<main id="page"></main>
<aside id="source" role="status" aria-live="polite" hidden></aside>
<script type="application/json" id="data">{data}</script>
<script>{script}</script>
</body>
</html>
"""


def write_page(contents: dict[str, Any], path: Path) -> Path:
    """One file of at most 10 MB; UserError if the logs have more to show."""
    text = page_text(contents)
    if len(text.encode()) > LARGEST_BYTES:
        size = f"{len(text) / 1e6:.0f} MB"
        raise UserError(
            f"{printable(path)}: would have {size}; make a page of fewer runs, or leave out --html"
        )
    return write_text(text, path)


def page_text(contents: dict[str, Any]) -> str:
    """Whatever the data say, they stay data: no name ends the element, and no other script runs."""
    script = _script()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    allowed = f"style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    data = json.dumps(contents, allow_nan=False, separators=(",", ":"))
    return _SHELL.format(
        policy=f"default-src 'none'; {allowed}; base-uri 'none'",
        title=escape(contents["title"]),
        style=_resource("page.css"),
        data=data.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"),
        script=script,
    )


def read_page(path: Path) -> dict[str, Any]:
    """The data of a page; UserError for a file that is none."""
    try:
        text = path.read_text(encoding="utf-8")
        found = _DataOf()
        found.feed(text)
        contents = json.loads("".join(found.data))
    except FileNotFoundError as error:
        raise UserError(f"{printable(path)}: there is no such file") from error
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{printable(path)}: is no report of `swarm analyze --html` ({error})") from error
    if not isinstance(contents, dict):
        raise UserError(f"{printable(path)}: is no report of `swarm analyze --html`")
    return contents


class _DataOf(HTMLParser):
    """Collects what stands in the element of the data."""

    def __init__(self) -> None:
        super().__init__()
        self.data: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "script" and ("id", DATA) in attrs

    def handle_endtag(self, tag: str) -> None:  # noqa: ARG002
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.data.append(data)


def _script() -> str:
    """In a function of its own, strict."""
    parts = "\n".join(_resource(name) for name in SCRIPTS)
    return f'(function () {{\n"use strict";\n{parts}}})();\n'


def _resource(name: str) -> str:
    return (files(__package__) / "browser" / name).read_text(encoding="utf-8")
