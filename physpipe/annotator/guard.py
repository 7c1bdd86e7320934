"""Keeps others out: a page of another site in the same browser, and names that lead to this machine by a detour.

The server listens on the loopback address alone, so other machines cannot reach it. A foreign page can, through the
browser: by a form or a script (its `Origin` or `Sec-Fetch-Site` tells), or by a name of its own that it lets point to
127.0.0.1 (the `Host` tells).
"""

from flask import Flask, Response, abort, request

HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


def install(app: Flask, address: str) -> None:
    """Refuses whatever is not meant for `address` (`127.0.0.1:8765`), or comes from a page that is not from there."""

    @app.before_request
    def refuse_strangers() -> None:
        if request.headers.get("Host") != address:
            abort(403, f"open http://{address}/: requests to another name are refused")
        if request.headers.get("Origin", f"http://{address}") != f"http://{address}":
            abort(403, "requests from pages of another origin are refused")
        # A link may lead here: what it opens can neither be read nor framed by the page that it stands on.
        if request.path != "/" and request.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            abort(403, "requests from other sites are refused")

    @app.after_request
    def harden(response: Response) -> Response:
        response.headers.update(HEADERS)
        return response
