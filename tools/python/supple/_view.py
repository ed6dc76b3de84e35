"""A session in a notebook: the viewer in a frame, or pictures with a slider where nothing runs."""
from __future__ import annotations

import atexit
import base64
import json
import os
import shutil
import tempfile
from typing import Any, Callable, List, Optional, Sequence

from ._errors import Error, SystemError
from ._scene import show
from ._session import Session
from ._volume import Progress

_PAGE = """<!doctype html><meta charset="utf-8"><title>supple</title>
<style>body { margin: 0; text-align: center; font: 14px sans-serif } img { max-width: 100% }
input { width: 50%; vertical-align: middle }</style>
<img alt="the body"><br><label>at rest <input type="range" min="0"> deformed</label>
<script>
const pictures = PICTURES, image = document.querySelector("img");
const slider = document.querySelector("input");
const turn = () => { image.src = "data:image/png;base64," + pictures[slider.value]; };
slider.max = slider.value = pictures.length - 1;
slider.oninput = turn;
turn();
</script>
"""


class View:
    """What view() shows in a notebook. address: of the viewer, with the key of its session, or
    None. page: HTML of the pictures, which needs nothing else, or None where the viewer runs.
    frame: HTML that shows it. stop: what ends it."""

    def __init__(self, frame: str, *, address: Optional[str] = None, page: Optional[str] = None,
                 stop: Callable[[], Any] = lambda: None):
        self.address, self.page = address, page
        self._frame, self._stop = frame, stop

    def stop(self) -> None:
        """Ends the viewer, as the end of the interpreter does; what was not saved is lost."""
        self._stop()

    def _repr_html_(self) -> str:
        return self._frame


def view(session: Session, *, live: Optional[bool] = None, base_url: str = "",
         origins: Sequence[str] = ("http://localhost:8888", "http://127.0.0.1:8888"),
         height: int = 640, steps: int = 4, progress: Progress = None, **look: Any) -> View:
    """The viewer (`supple view`) on a copy of a session, in a frame of `height` pixels.

    live: False, or None where there is no program: a page of `steps` + 1 pictures from rest to the
    body, which needs neither. base_url: path below which a proxy of the notebook shows a port of
    this machine, such as "/user/me/proxy/{port}/". origins: what addresses of the notebook begin
    with. look: keys of show(); the viewer takes `preset`. Raises SystemError with live=True where
    there is no program, Error with its line where it fails.
    """
    import html
    program = _program() if live is not False else None
    if program is None and live:
        raise SystemError("supple: found no program, expected it beside the package or in PATH")
    if program is None:
        parts = [number / steps for number in range(steps + 1)] if steps > 0 else [1.0]
        pictures = [show(session, amount=part, progress=progress, **{"size": [480, 480], **look})
                    for part in parts]
        texts = [base64.b64encode(picture.png).decode() for picture in pictures]
        page = _PAGE.replace("PICTURES", json.dumps(texts))
        return View(_frame(f'srcdoc="{html.escape(page)}" sandbox="allow-scripts"', height),
                    page=page)
    options = ["--preset", look["preset"]] if "preset" in look else []
    for origin in origins:
        options += ["--embed", origin]
    path = ""
    if base_url:
        port = _free_port()
        path = base_url.format(port=port)
        options += ["--port", str(port), "--base-path", path]
        for origin in origins:
            options += ["--origin", origin]
    return _start(program, session, options, path, height, progress)


def _start(program: str, session: Session, options: List[str], path: str, height: int,
           progress: Progress) -> View:
    import html  # late, as all that a start of the package would wait for
    import subprocess
    folder = tempfile.TemporaryDirectory(prefix="supple-")
    state, log = (os.path.join(folder.name, name) for name in ("session.vdb", "log"))
    session.save(state, progress=progress)
    with open(log, "w") as errors:
        process = subprocess.Popen(
            [program, "view", state, "--no-browser", "--no-journal", "--grace", "600", *options],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, text=True)

    def stop() -> None:
        atexit.unregister(stop)
        process.terminate()
        process.communicate()
        folder.cleanup()

    atexit.register(stop)
    assert process.stdout is not None
    address = process.stdout.readline().strip()
    if not address:
        with open(log) as told:
            line = told.read().strip()
        stop()
        raise Error(line or f"{program}: the viewer ended")
    shown = path + "#" + address.partition("#")[2] if path else address
    return View(_frame(f'src="{html.escape(shown)}"', height), address=address, stop=stop)


def _frame(content: str, height: int) -> str:
    return f'<iframe {content} width="100%" height="{height}" style="border: 0"></iframe>'


def _program() -> Optional[str]:
    """The program of a wheel, of a build folder, or of the system."""
    package = os.path.dirname(os.path.abspath(__file__))
    for place in ("_native/supple", "../../bin/supple"):
        program = os.path.join(package, place)
        if os.access(program, os.X_OK):
            return os.path.normpath(program)
    return shutil.which("supple")


def _free_port() -> int:
    import socket
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]
