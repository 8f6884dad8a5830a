"""Notebooks: whether this is one, the address of its server, and pages in its cells."""

from __future__ import annotations

import html
import importlib.util
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit


class Notebook:
    """The notebook that this kernel belongs to."""

    def __init__(self, origins: Sequence[str], base: str, proxied: bool) -> None:
        self.origins, self._base, self._proxied = list(origins), base, proxied

    def address(self, url: str) -> str:
        """Returns the address of a page of this machine for the notebook's cells."""
        if not self._proxied:
            return url
        parts = urlsplit(url)
        return f"{self._base}proxy/{parts.port}/?{parts.query}"

    def show(self, url: str, height: int = 720) -> None:
        """Shows a page in the cell that runs."""
        from IPython.display import HTML, display

        address = html.escape(self.address(url))
        display(HTML(f'<iframe src="{address}" style="width: 100%; height: {height}px; border: 0" '  # type: ignore[no-untyped-call]
                     f'allow="clipboard-write; fullscreen"></iframe>'
                     f'<a href="{address}" target="_blank">Open the editor in a tab of its own</a>'))


def notebook(origin: str | Sequence[str] | None, proxy: bool | None) -> Notebook | None:
    """Returns the notebook that this kernel belongs to; None in a terminal or a script."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if getattr(shell, "kernel", None) is None:
        return None
    server = _server()
    port = urlsplit(server["url"]).port if server else None
    scheme = "https" if server and server.get("secure") else "http"
    local = [f"{scheme}://{host}:{port}" for host in ("localhost", "127.0.0.1")] if server else []
    origins = local if origin is None else [origin] if isinstance(origin, str) else list(origin)
    base = server["base_url"] if server else os.environ.get("JUPYTERHUB_SERVICE_PREFIX", "/")
    has_proxy = importlib.util.find_spec("jupyter_server_proxy") is not None
    return Notebook(origins, base, has_proxy if proxy is None else proxy)


def _server() -> dict[str, Any] | None:
    """Returns what the server that started this kernel has written about itself."""
    try:
        from jupyter_core.paths import jupyter_runtime_dir
    except ImportError:
        return None
    parent = int(os.environ.get("JPY_PARENT_PID") or os.getppid())
    for kind in ("jpserver", "nbserver"):
        file = Path(jupyter_runtime_dir()) / f"{kind}-{parent}.json"
        try:
            return dict(json.loads(file.read_text(encoding="utf-8")))
        except (OSError, ValueError):
            continue
    return None
