"""The server: where it listens, what it says, and how it ends."""

import errno
import socket
import webbrowser
from pathlib import Path
from threading import Thread

import waitress
from waitress.server import BaseWSGIServer

from physpipe.annotator.answers import Answers
from physpipe.annotator.app import LARGEST_BODY, Desk, create_app
from physpipe.annotator.store import Store
from physpipe.baselines.template import TemplateParams
from physpipe.core.errors import InputError
from physpipe.core.params import read, read_value
from physpipe.io.clips import ClipSet

HERE = "127.0.0.1"
THREADS = 8
"""A browser opens six connections to a page: none should queue."""


def annotate(name: str, clips: Path, annotations: Path, port: int, show: bool) -> None:
    """Serves the page for data set `name` until Ctrl+C, and opens it in the browser where `show` is set.

    Raises InputError for a set that is not filmed or has no clips, files with bad lines, and a port in use.
    """
    desk = open_desk(name, clips, annotations)
    server, url = open_server(desk, port)
    print(f"Annotate {name}: {url}\nEvery change is saved at once, into {annotations}. Ctrl+C ends it.")
    if show:
        Thread(target=webbrowser.open, args=[url], daemon=True).start()  # some browsers hold up whoever opens them
    server.run()


def open_desk(name: str, clips: Path, annotations: Path) -> Desk:
    """What the page of data set `name` works on; raises InputError as `annotate` does."""
    if "simulate" in read_value(f"datasets.{name}"):
        reason = "is simulated: its truth is exact, and DVC writes its annotations"
        raise InputError(f"data set `{name}`", reason, "annotate a filmed set")
    film = ClipSet(clips)
    store = Store(annotations, film)
    store.read()
    return Desk(
        name,
        store,
        Answers(film, read("ground_truth", TemplateParams)),
        read_value(f"datasets.{name}.motion.objects") or 1,
    )


def open_server(desk: Desk, port: int) -> tuple[BaseWSGIServer, str]:
    """The server, listening but not yet running, and the page's address; port 0 is any free one."""
    listener = _listener(port)
    address = f"{HERE}:{listener.getsockname()[1]}"
    app = create_app(desk, address)
    server = waitress.create_server(app, sockets=[listener], threads=THREADS, max_request_body_size=LARGEST_BODY)
    return server, f"http://{address}/"


def _listener(port: int) -> socket.socket:
    try:
        return socket.create_server((HERE, port))
    except OSError as error:
        reason = (
            "the port is in use" if error.errno == errno.EADDRINUSE else f"cannot be listened at ({error.strerror})"
        )
        mend = "end the other `physpipe annotate`, or choose another port with `--port`; 0 is any free one"
        raise InputError(f"{HERE}:{port}", reason, mend) from None
    except OverflowError:
        raise InputError(f"--port {port}", "no such port", "give one from 0 to 65535") from None
