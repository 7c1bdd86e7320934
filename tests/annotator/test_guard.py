"""Who is let in: the page itself and nobody else."""

import pytest
from rink import ADDRESS, ANNOTATIONS


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example:8765"},  # a name that its owner points to 127.0.0.1
        {"Host": "127.0.0.1:80"},
        {"Host": "localhost:8765"},  # its pages would keep their unsaved changes apart from those of 127.0.0.1
        {"Host": ADDRESS, "Origin": "http://evil.example"},
        {"Host": ADDRESS, "Origin": "null"},
        {"Host": ADDRESS, "Origin": "http://127.0.0.1:9999"},
        {"Host": ADDRESS, "Sec-Fetch-Site": "cross-site"},
        {"Host": ADDRESS, "Sec-Fetch-Site": "same-site"},
    ],
)
@pytest.mark.parametrize(
    ("method", "place"), [("GET", "/api/set"), ("PUT", "/api/clips/a"), ("GET", "/page/../app.py")]
)
def test_strangers_are_refused(client, headers, method, place):
    refused = client.open(place, method=method, headers=headers, json=None if method == "GET" else {})
    assert refused.status_code == 403
    assert not ANNOTATIONS.exists()


def test_a_link_may_lead_to_the_page_and_to_nothing_else(client):
    followed = {"Host": ADDRESS, "Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    page = client.get("/", headers=followed)
    assert page.status_code == 200
    assert "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]
    assert client.get("/api/clips/a", headers=followed).status_code == 403
