"""What the server answers to the page, and what it refuses to others."""

import re
import socket
from http.client import HTTPConnection
from pathlib import Path

import cv2
import numpy as np
import pytest
from rink import ADDRESS, ANNOTATIONS, CLIPS, H, T, W, film, running

from physpipe.annotator.app import LARGEST_BODY
from physpipe.core.errors import InputError

HOME = {"Host": ADDRESS}
BOX = {"object": 0, "frame": 0, "x": 3, "y": 6, "w": 15, "h": 15}
EMPTY = {"boxes": [], "corrections": []}


def test_the_page_and_its_parts_come_from_here_alone(client):
    page = client.get("/", headers=HOME)
    assert page.status_code == 200
    text = page.get_data(as_text=True)
    assert "http:" not in text
    assert "https:" not in text
    assert "default-src 'none'" in page.headers["Content-Security-Policy"]
    for part in ("annotator.css", "annotator.js"):
        assert f"page/{part}" in text
        assert client.get(f"/page/{part}", headers=HOME).status_code == 200


def test_the_page_loads_every_script_beside_it_and_each_is_served_as_one(client):
    waiting, loaded = ["annotator.js"], set()
    while waiting:
        name = waiting.pop()
        script = client.get(f"/page/{name}", headers=HOME)
        assert (script.status_code, script.mimetype) == (200, "text/javascript")
        assert "script-src 'self'" in script.headers["Content-Security-Policy"]
        loaded.add(name)
        imported = re.findall(r'^import .* from "(.+)";$', script.get_data(as_text=True), re.MULTILINE)
        waiting += {each.removeprefix("./") for each in imported} - loaded
    assert loaded == {path.name for path in Path(client.application.static_folder).glob("*.js")}


def test_a_clip_is_told_with_its_size_times_and_state(client, annotate_files):
    annotate_files(templates="clip,object,frame,x,y,w,h\na,0,0,3,6,15,15\n")
    listed = client.get("/api/set", headers=HOME).get_json()
    assert (listed["name"], listed["objects"]) == ("rink", 2)
    assert [(each["name"], each["templates"], each["corrections"]) for each in listed["clips"]] == [
        ("a", 1, 0),
        ("b", 0, 0),
    ]
    clip = client.get("/api/clips/a", headers=HOME).get_json()
    assert (clip["width"], clip["height"], len(clip["times_s"]), clip["status"][9]) == (W, H, T, "decode_error")
    assert clip["state"] == {"boxes": [BOX], "corrections": []}
    assert not clip["referenced"]


def test_a_frame_is_shown_to_the_bit(client):
    coded = client.get("/api/clips/b/frames/7", headers=HOME)
    assert coded.mimetype == "image/png"
    shown = cv2.imdecode(np.frombuffer(coded.data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    np.testing.assert_array_equal(shown, film()[7])


def test_boxes_are_answered_without_being_saved(client):
    answer = client.post("/api/clips/a/answer", json={"boxes": [BOX], "corrections": []}, headers=HOME)
    found = answer.get_json()["0"]
    assert len(found["x"]) == len(found["score"]) == T
    assert (found["x"][0], found["y"][0]) == (10, 13)  # the middle of the box
    assert not ANNOTATIONS.exists()


def test_a_change_is_saved_and_a_second_one_to_the_same_state_refused(client, desk):
    clip = client.get("/api/clips/a", headers=HOME).get_json()
    about = {"place": desk.place, "revision": clip["revision"]}
    change = about | {"state": {"boxes": [BOX], "corrections": []}}
    saved = client.put("/api/clips/a", json=change, headers=HOME)
    assert saved.status_code == 200
    assert "a,0,0,3,6,15,15" in (ANNOTATIONS / "templates.csv").read_text()
    refused = client.put("/api/clips/a", json=about | {"state": EMPTY}, headers=HOME)
    assert refused.status_code == 409
    told = refused.get_json()
    assert "changed elsewhere" in told["error"]
    assert told["state"] == change["state"]
    assert told["revision"] == saved.get_json()["revision"]
    assert client.put("/api/clips/a", json=told | {"state": EMPTY}, headers=HOME).status_code == 422  # has a key more
    again = {"place": desk.place, "revision": told["revision"], "state": EMPTY}
    assert client.put("/api/clips/a", json=again, headers=HOME).status_code == 200


def test_a_page_left_open_does_not_write_into_another_set(client, desk):
    change = {"place": "another", "revision": "", "state": EMPTY}
    refused = client.put("/api/clips/a", json=change, headers=HOME)
    assert refused.status_code == 410
    assert "another data set is served here" in refused.get_json()["error"]


def test_files_spoilt_while_the_page_is_open_are_told_line_by_line(client, annotate_files):
    annotate_files(corrections="clip,object,frame,x,y,visible\nz,0,0,1,1,true\na,0,99,1,1,true\na,0,1,1,1,perhaps\n")
    told = client.get("/api/clips/a", headers=HOME)
    assert told.status_code == 422
    for fault in ("no such clip: line 2", "frame beyond the clip: line 3", "`visible` is not true or false: line 4"):
        assert fault in told.get_json()["error"]


@pytest.mark.parametrize(
    "place",
    [
        "/api/clips/../../params.yaml",
        "/api/clips/..%2F..%2Fparams.yaml",
        "/api/clips/%2e%2e/frames/0",
        "/api/clips/clips.parquet/frames/0",
        "/api/clips/%00/frames/0",
        "/api/clips/a/frames/-1",
        f"/api/clips/a/frames/{T}",
        "/page/../app.py",
        "/page/..%2Fapp.py",
        "/page//etc/passwd",
        "/data/clips/rink/a.npy",
    ],
)
def test_no_path_leads_out_of_the_clip_table(client, place):
    refused = client.get(place, headers=HOME)
    assert refused.status_code == 404
    assert "params.yaml: " not in refused.get_data(as_text=True)


def test_changes_to_unknown_clips_make_no_file(client):
    for name in ("c", "..", "%2e%2e%2fx"):
        refused = client.put(f"/api/clips/{name}", json={"place": "", "revision": "", "state": EMPTY}, headers=HOME)
        assert refused.status_code in (404, 405)
    assert not ANNOTATIONS.exists()


@pytest.mark.parametrize(
    ("method", "place"),
    [("POST", "/"), ("DELETE", "/api/clips/a"), ("POST", "/api/clips/a"), ("GET", "/api/clips/a/answer")],
)
def test_wrong_methods_are_refused(client, method, place):
    assert client.open(place, method=method, headers=HOME, json={}).status_code == 405


@pytest.mark.parametrize(
    ("body", "kind", "code"),
    [
        ("revision=1", "application/x-www-form-urlencoded", 415),
        ('{"revision": ""}', "text/plain", 415),
        ("{", "application/json", 422),
        (
            '{"place": "", "revision": "", "state": {"boxes": [], "corrections": [{"object": 0}]}}',
            "application/json",
            422,
        ),
        (
            '{"place": "", "revision": "", "state": {"boxes": [], "corrections": [], "more": 1}}',
            "application/json",
            422,
        ),
        (" " * (LARGEST_BODY + 1), "application/json", 413),
    ],
)
def test_bad_bodies_are_refused_with_a_sentence(client, body, kind, code):
    refused = client.put("/api/clips/a", data=body, content_type=kind, headers=HOME)
    assert refused.status_code == code
    assert len(refused.get_json()["error"]) > 5
    assert not ANNOTATIONS.exists()


def test_a_huge_body_is_cut_off_by_the_server_too(desk):
    with running(desk) as page:
        connection = HTTPConnection("127.0.0.1", page.port, timeout=5)
        connection.putrequest("PUT", "/api/clips/a")
        connection.putheader("Content-Type", "application/json")
        connection.putheader("Content-Length", str(10**12))
        connection.endheaders()
        assert connection.getresponse().status == 413
        connection.close()


def test_the_page_listens_on_the_loopback_address_alone(desk):
    with running(desk) as page:
        socket.create_connection(("127.0.0.1", page.port), timeout=5).close()
        with pytest.raises(OSError, match="refused"):  # all of 127/8 is loopback; another address of it is not ours
            socket.create_connection(("127.0.0.2", page.port), timeout=5)


def test_clip_names_are_never_paths(desk):
    with pytest.raises(InputError, match="no clip"):
        desk.store.clips.rows(str(CLIPS / "a"))
