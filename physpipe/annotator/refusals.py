"""How the server says no: JSON with one sentence, which the page shows as it is."""

from typing import Any

from flask import Flask
from pydantic import ValidationError
from werkzeug.exceptions import HTTPException

from physpipe.annotator.store import StaleError
from physpipe.core.errors import InputError


def install(app: Flask) -> None:
    """Makes every refusal of `app` such an answer, with the HTTP status that fits."""

    @app.errorhandler(InputError)
    def unusable(error: InputError) -> tuple[dict[str, Any], int]:
        return {"error": str(error)}, 422

    @app.errorhandler(ValidationError)
    def malformed(error: ValidationError) -> tuple[dict[str, Any], int]:
        faults = [f"`{'.'.join(map(str, each['loc']))}`: {each['msg']}" for each in error.errors()]
        return {"error": f"not an annotation: {'; '.join(faults[:5])}"}, 422

    @app.errorhandler(StaleError)
    def stale(error: StaleError) -> tuple[dict[str, Any], int]:
        return {"error": str(error), "revision": error.now.revision, "state": error.now.model_dump()}, 409

    @app.errorhandler(HTTPException)
    def refused(error: HTTPException) -> tuple[dict[str, Any], int]:
        return {"error": error.description}, error.code or 500
