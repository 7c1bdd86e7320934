"""What the page asks of the server: the set, a clip, its frames, the tracker's answer; and the one thing it changes."""

import mimetypes
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any, TypeVar

import cv2
import numpy as np
import pandas as pd
from flask import Flask, Response, abort, request
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from physpipe.annotator import guard, refusals, states
from physpipe.annotator.answers import Answers, referenced
from physpipe.annotator.states import ClipState
from physpipe.annotator.store import Store
from physpipe.core.errors import InputError
from physpipe.trackers.base import Trajectory

LARGEST_BODY = 8 * 2**20
"""Bytes; a clip with corrections in ten thousand frames takes one million."""
Body = TypeVar("Body", bound=BaseModel)


@dataclass(frozen=True)
class Desk:
    """Everything about the data set that is annotated."""

    name: str
    store: Store
    answers: Answers
    objects: int
    """How many objects to offer in a clip that nobody annotated."""

    @property
    def place(self) -> str:
        """A name of the annotated folder, which tells a page left open that another one is served at its address."""
        return sha256(str(self.store.folder.resolve()).encode()).hexdigest()[:16]


class Change(BaseModel):
    """A clip's new state, the revision of the one that it was made from, and the folder that both belong to."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    place: str
    revision: str
    state: ClipState


def create_app(desk: Desk, address: str) -> Flask:
    """The application for `address` (`127.0.0.1:8765`); anything else it refuses to answer."""
    mimetypes.add_type("text/javascript", ".js")  # browsers run nothing else; a registry on Windows may say otherwise
    app = Flask(__name__, static_folder="page", static_url_path="/page")
    app.config["MAX_CONTENT_LENGTH"] = LARGEST_BODY
    app.url_map.merge_slashes = False
    guard.install(app, address)
    refusals.install(app)
    _add_reading(app, desk)
    _add_changing(app, desk)
    return app


def _add_reading(app: Flask, desk: Desk) -> None:
    clips, store = desk.store.clips, desk.store

    @app.get("/")
    def page() -> Response:
        return app.send_static_file("index.html")

    @app.get("/api/set")
    def about_set() -> dict[str, Any]:
        given = store.read()
        said = {file: table["clip"].value_counts() for file, table in vars(given).items()}
        listed = [
            {"name": name, "split": clips.split(name)} | {file: int(rows.get(name, 0)) for file, rows in said.items()}
            for name in clips.names()
        ]
        return {"name": desk.name, "place": desk.place, "objects": desk.objects, "clips": listed}

    @app.get("/api/clips/<name>")
    def about_clip(name: str) -> dict[str, Any]:
        rows, given = _rows_or_404(desk, name), store.read()
        state = states.of_clip(given, name)
        return {
            "name": name,
            "width": int(rows["width"].iloc[0]),
            "height": int(rows["height"].iloc[0]),
            "times_s": rows["time_s"].tolist(),
            "status": rows["status"].tolist(),
            "referenced": referenced(name, given),
            "revision": state.revision,
            "state": state.model_dump(),
        }

    @app.get("/api/clips/<name>/frames/<int:number>")
    def frame(name: str, number: int) -> Response:
        _rows_or_404(desk, name)
        frames = clips.frames(name)
        if number >= len(frames):
            abort(404, f"clip {name} has {len(frames)} frames")
        return Response(_png(frames[number]), mimetype="image/png")


def _add_changing(app: Flask, desk: Desk) -> None:
    """What takes a body. The answer to boxes that are not saved yet changes nothing on disk."""

    @app.post("/api/clips/<name>/answer")
    def answer(name: str) -> dict[str, Any]:
        _rows_or_404(desk, name)
        given = replace(desk.store.checked(name, _body(ClipState)), reference=desk.store.read().reference)
        return {str(k): _plain(trajectory) for k, trajectory in desk.answers.of(name, given).items()}

    @app.put("/api/clips/<name>")
    def change(name: str) -> dict[str, Any]:
        _rows_or_404(desk, name)
        wanted = _body(Change)
        if wanted.place != desk.place:
            abort(
                410, "another data set is served here by now: serve the one of this page again, or open the page anew"
            )
        return {"revision": desk.store.save(name, wanted.state, wanted.revision).revision}


def _body(kind: type[Body]) -> Body:
    """The request's JSON; a form, which any page can send, has another content type."""
    if not request.is_json:
        abort(415, "send JSON")
    return kind.model_validate_json(request.get_data())


def _rows_or_404(desk: Desk, name: str) -> pd.DataFrame:
    """The clip's rows. Only names of the clip table pass, so that no path can be made from a request."""
    try:
        return desk.store.clips.rows(name)
    except InputError as error:
        abort(404, str(error))


def _plain(trajectory: Trajectory) -> dict[str, list[float | None]]:
    """Columns for JSON, null where the object is lost."""
    columns = {"x": trajectory.xy[:, 0], "y": trajectory.xy[:, 1], "score": trajectory.score}
    return {name: [round(float(v), 3) if np.isfinite(v) else None for v in each] for name, each in columns.items()}


def _png(frame: NDArray[np.uint8]) -> bytes:
    """Lossless, so that a person sees what the trackers see."""
    return cv2.imencode(".png", cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))[1].tobytes()
