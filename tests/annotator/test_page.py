"""The page in a real browser: everything by keyboard, nothing lost, strangers kept out."""

import http.server
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from threading import Thread

import numpy as np
import pandas as pd
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Route, expect, sync_playwright
from rink import ANNOTATIONS, CLIPS, T, path, running

from physpipe.annotator import serving
from physpipe.annotator.app import Change, Desk
from physpipe.annotator.states import ClipState, CorrectionRow
from physpipe.baselines.ground_truth import ground_truth
from physpipe.baselines.template import TemplateParams
from physpipe.core.params import read
from physpipe.io import annotations, tracks
from physpipe.io.clips import ClipSet

TEMPLATES = "clip,object,frame,x,y,w,h\na,0,0,3,6,15,15\na,1,0,3,28,15,15\n"
FOREIGN = "evil.example"
"""A name that the browser of these tests takes to this machine, as its owner's name server would."""
expect.set_options(timeout=30_000)  # a busy machine is slow, not wrong


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    flags = ["--no-sandbox", f"--host-resolver-rules=MAP {FOREIGN} 127.0.0.1"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=flags)
        yield browser
        browser.close()


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    """A fresh browser; what its pages' scripts complain of fails the test."""
    context = browser.new_context(viewport={"width": 900, "height": 600})
    complaints: list[str] = []
    context.on("weberror", lambda error: complaints.append(str(error.error)))
    yield context
    context.close()
    assert complaints == []


def opened(context: BrowserContext, url: str, said: str = "frame ") -> Page:
    page = context.new_page()
    page.goto(url)
    expect(page.locator("#where")).to_contain_text(said)
    return page


def press(page: Page, *keys: str) -> None:
    for key in keys:
        page.keyboard.press(key)


def saved(page: Page) -> None:
    expect(page.locator("#saved")).to_have_text("saved")


def corrections() -> pd.DataFrame:
    return pd.read_csv(ANNOTATIONS / "corrections.csv").set_index(["clip", "object", "frame"])


def truth() -> pd.DataFrame:
    clips = ClipSet(CLIPS)
    table = ground_truth(clips, annotations.load(ANNOTATIONS, clips), read("ground_truth", TemplateParams))
    return table.set_index(tracks.KEY)


def on_screen(page: Page, xy: np.ndarray) -> tuple[float, float]:
    """Where a position in clip pixels is on the screen: the clip fills the view's height or width, in its middle."""
    view = page.locator("#view").bounding_box()
    assert view is not None
    scale = min(view["width"] / 64, view["height"] / 48)
    left, top = view["x"] + (view["width"] - 64 * scale) / 2, view["y"] + (view["height"] - 48 * scale) / 2
    return left + (xy[0] + 0.5) * scale, top + (xy[1] + 0.5) * scale


def test_fifty_frames_are_annotated_by_keyboard_alone(desk: Desk, context: BrowserContext) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "1", "b", *["ArrowLeft"] * 22, "Shift+ArrowDown", "ArrowDown", "Alt+ArrowRight", "+", "+", "+")
        press(page, "Enter")  # a box around disc 1
        expect(page.locator("#where")).to_contain_text("score 1.00")
        for _ in range(50):
            press(page, "d", "ArrowRight")
        saved(page)
    box = pd.read_csv(ANNOTATIONS / "templates.csv").iloc[0]
    assert (box["object"], box["frame"]) == (1, 0)
    centre = np.array([box["x"] + (box["w"] - 1) / 2, box["y"] + (box["h"] - 1) / 2])
    assert np.abs(centre - path(1)[0]).max() <= 1  # pixels: the box was steered to the disc
    rows = truth().loc[("a", 1)]
    assert (rows["status"] == "corrected").tolist() == [1 <= t <= 50 for t in range(T)]
    expected = path(1) + centre - path(1)[0]
    assert np.abs(rows.loc[[0, 51, 52, 53], ["x", "y"]] - expected[[0, 51, 52, 53]]).max(axis=None) < 0.3  # pixels
    moved = rows.loc[1:50, ["x", "y"]].to_numpy() - expected[1:51]
    assert np.abs(moved - [1, 0]).max() < 0.3  # the tracker's own error
    assert corrections().loc[("a", 1, 50), "x"] == pytest.approx(rows.loc[50, "x"], abs=1e-5)


def test_the_page_says_what_ground_truth_makes_of_the_files(desk, context, annotate_files) -> None:
    said = "clip,object,frame,x,y,visible\na,0,2,30.5,20.25,true\na,0,3,,,false\na,0,4,9,9,false\n"
    annotate_files(templates=TEMPLATES, corrections=said)
    rows = truth().loc[("a", 0)]
    with running(desk) as server:
        page = opened(context, server.url + "#clip=a&frame=1")
        expect(page.locator("#where")).to_contain_text(f"({rows.loc[1, 'x']:.1f}, {rows.loc[1, 'y']:.1f}) px")
        for words in ("(30.5, 20.3) px", "lost, by hand", "occluded: a guess", "the tracker's answer"):
            press(page, "d")
            expect(page.locator("#where")).to_contain_text(words)
        press(page, "Home", *["d"] * 9)
        expect(page.locator("#badge")).to_have_text("this frame could not be decoded: an older picture")
    assert rows.loc[2:4, "visible"].tolist() == [True, False, False]


def test_marks_go_over_spans_and_are_taken_back(desk, context, annotate_files) -> None:
    annotate_files(templates=TEMPLATES)
    with running(desk) as server:
        page = opened(context, server.url)
        expect(page.locator("#where")).to_contain_text("score")
        press(page, "d", "l", "d", "d", "Shift+l", "d", "o", "d", "d", "Shift+o")
        saved(page)
        rows = corrections().loc[("a", 0)]
        assert rows.index.tolist() == [1, 2, 3, 4, 5, 6]
        assert not rows["visible"].any()
        assert rows["x"].isna().tolist() == [True] * 3 + [False] * 3
        assert np.abs(rows.loc[4:6, ["x", "y"]] - path(0)[4:7]).max(axis=None) < 0.3  # pixels: where the tracker saw it
        press(page, "o", "a", "Delete")  # frame 6 is seen after all; frame 5 is the tracker's again
        saved(page)
        rows = corrections().loc[("a", 0)]
        assert rows["visible"].to_dict() == {1: False, 2: False, 3: False, 4: False, 6: True}
        press(page, "End", "1", "Shift+l")
        expect(page.locator("#hint")).to_contain_text("No earlier frame of object 1 is lost")


def test_interpolated_frames_follow_their_keys_and_undo_goes_all_the_way_back(desk, context, annotate_files) -> None:
    annotate_files(corrections="clip,object,frame,x,y,visible\na,0,10,20,10,true\na,0,15,30,20,true\n")
    with running(desk) as server:
        page = opened(context, server.url + "#clip=a&frame=15", "frame 15")
        press(page, "i")
        saved(page)
        rows = corrections().loc[("a", 0)]
        np.testing.assert_allclose(rows.loc[10:15, "x"], np.linspace(20, 30, 6), atol=0.01)  # pixels
        assert rows["interpolated"].tolist() == [False, True, True, True, True, False]
        press(page, "Shift+ArrowRight")
        saved(page)
        np.testing.assert_allclose(corrections().loc[("a", 0)]["x"], np.linspace(20, 40, 6), atol=0.01)
        press(page, "q")
        expect(page.locator("#where")).to_contain_text("frame 10 ")
        press(page, "d", "o", "ArrowUp")  # 11 is hidden there, and then a key of its own
        saved(page)
        rows = corrections().loc[("a", 0)]
        assert rows.loc[11, ["visible", "interpolated"]].tolist() == [False, False]
        np.testing.assert_allclose(rows.loc[11:15, "y"], np.linspace(11, 20, 5), atol=0.01)
        for _ in range(4):
            press(page, "z")
        saved(page)
        assert "interpolated" not in corrections()
        assert corrections().loc[("a", 0)].index.tolist() == [10, 15]
        press(page, "Control+y")
        saved(page)
        assert corrections().loc[("a", 0), "x"].loc[15] == 30
        assert len(corrections()) == 6
        press(page, "Control+z", "z")
        expect(page.locator("#hint")).to_have_text("Nothing to undo.")


def test_a_point_is_dragged_and_a_box_drawn_with_the_mouse(desk, context) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "b")
        page.mouse.move(*on_screen(page, path(0)[0] - 8))  # outside the proposed box: a new one begins
        page.mouse.down()
        page.mouse.move(*on_screen(page, path(0)[0] + 7), steps=3)
        page.mouse.up()
        press(page, "d")  # going on keeps the box
        expect(page.locator("#where")).to_contain_text("score")
        press(page, *["d"] * 4)
        page.mouse.move(*on_screen(page, path(0)[5]))
        page.mouse.down()
        page.mouse.move(*on_screen(page, path(0)[5] + [6, 9]), steps=4)
        page.mouse.up()
        saved(page)
        assert corrections().loc[("a", 0, 5), ["x", "y"]].to_numpy(float) == pytest.approx(path(0)[5] + [6, 9], abs=0.3)
        press(page, "z")
        expect(page.locator("#where")).to_contain_text("the tracker's answer")
        saved(page)
        assert corrections().empty
        box = pd.read_csv(ANNOTATIONS / "templates.csv").iloc[0]
        assert np.abs(box[["x", "y"]].to_numpy(float) - (path(0)[0] - 7.5)).max() <= 1  # whole pixels


TO_AND_FRO = """[["ArrowLeft", true], ["ArrowRight", false]].forEach(([key, shiftKey]) =>
    document.body.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey, bubbles: true })))"""
"""10 px to the left and 1 to the right, both before the server can answer to the first."""


@pytest.mark.parametrize(("choice", "x"), [("theirs", 41), ("mine", 31)])
def test_a_second_tab_is_told_and_chooses_and_undo_holds_the_other(desk, context, annotate_files, choice, x) -> None:
    annotate_files(corrections="clip,object,frame,x,y,visible\na,0,0,40,20,true\nb,0,0,3,3,true\n")
    with running(desk) as server:
        first, second = opened(context, server.url), opened(context, server.url)
        press(first, "ArrowRight")
        saved(first)
        second.evaluate(TO_AND_FRO)
        dialog = second.locator("#conflict")
        expect(dialog).to_contain_text("a was changed elsewhere")
        press(second, "Escape", "Escape", "z")  # neither leaves the choice nor reaches the page
        expect(dialog).to_be_visible()
        assert corrections().loc[("a", 0, 0), "x"] == 41
        second.locator(f"button[value={choice}]").press("Enter")
        expect(second.locator("#where")).to_contain_text(f"({x}.0, 20.0) px")
        saved(second)
        assert corrections().loc[("a", 0, 0), "x"] == x
        press(second, "z")
        expect(second.locator("#where")).to_contain_text(f"({72 - x}.0, 20.0) px")
        saved(second)
        assert corrections()["x"].to_dict() == {("a", 0, 0): 72 - x, ("b", 0, 0): 3}


def test_tabs_on_different_clips_do_not_meet(desk, context) -> None:
    with running(desk) as server:
        first, second = opened(context, server.url), opened(context, server.url + "#clip=b")
        press(first, "ArrowRight")
        saved(first)
        press(second, "ArrowRight")
        saved(second)
    assert corrections().index.get_level_values("clip").tolist() == ["a", "b"]


def test_work_goes_on_while_the_server_is_gone_and_is_saved_when_it_is_back(desk, context) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "ArrowRight")
        saved(page)
    press(page, "d", "ArrowRight", "d", "l")
    expect(page.locator("#saved")).to_contain_text("the server does not answer")
    assert len(corrections()) == 1
    with running(serving.open_desk("rink", CLIPS, ANNOTATIONS), server.port):
        saved(page)
        assert len(corrections()) == 3


def test_what_a_crashed_tab_had_not_saved_is_back_when_the_page_is_opened_again(desk, context) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "ArrowRight")
        saved(page)
    press(page, "d", "ArrowRight")
    expect(page.locator("#saved")).to_contain_text("the server does not answer")
    page.close()  # without a word to the page
    with running(desk, server.port):
        again = opened(context, server.url)
        expect(again.locator("#hint")).to_contain_text("are back")
        saved(again)
        assert len(corrections()) == 2
        again.reload()
        expect(again.locator("#where")).to_contain_text("frame 0")
        expect(again.locator("#hint")).to_have_text("")


def test_what_a_crashed_tab_had_not_saved_meets_what_was_changed_since(desk, context, annotate_files) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
    press(page, "ArrowRight")
    expect(page.locator("#saved")).to_contain_text("the server does not answer")
    page.close()
    annotate_files(corrections="clip,object,frame,x,y,visible\na,0,7,1,1,true\n")
    with running(desk, server.port):
        again = context.new_page()
        again.goto(server.url)
        expect(again.locator("#conflict")).to_contain_text("What this browser kept from")
        again.locator("button[value=theirs]").press("Enter")
        saved(again)
        assert corrections().index.tolist() == [("a", 0, 7)]
        press(again, "z")
        saved(again)
        assert corrections().index.tolist() == [("a", 0, 0)]


def test_files_spoilt_by_hand_are_told_and_nothing_is_lost(desk, context, annotate_files) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        bad = "clip,object,frame,x,y,visible\nz,0,0,1,1,true\na,0,99,1,1,true\na,0,1,1,1,perhaps\n"
        annotate_files(corrections=bad)
        press(page, "ArrowRight")
        for line in ("no such clip: line 2", "frame beyond the clip: line 3", "`visible` is not true or false: line 4"):
            expect(page.locator("#alert")).to_contain_text(line)
        assert (ANNOTATIONS / "corrections.csv").read_text() == bad
        annotate_files(corrections="clip,object,frame,x,y,visible\nb,0,0,1,1,true\n")
        page.get_by_role("button", name="Try again").press("Enter")
        saved(page)
        expect(page.locator("#alert")).to_be_hidden()
    assert corrections().index.tolist() == [("a", 0, 0), ("b", 0, 0)]


def test_reference_positions_are_shown_corrected_and_need_no_box(desk, context, annotate_files) -> None:
    rows = [f"a.mp4,0,{5 + t},{40.5 + t},70.5" for t in range(T)]
    annotate_files(reference="\n".join(["source,object,frame,x,y", *rows]) + "\n")
    with running(desk) as server:
        page = opened(context, server.url)
        expect(page.locator("#where")).to_contain_text("the reference position")
        press(page, "b")
        expect(page.locator("#hint")).to_contain_text("reference positions")
        press(page, "ArrowDown")
        saved(page)
    kept = truth().loc[("a", 0)]["status"].tolist()
    assert [kept[0], kept[9]] == ["corrected", "lost"]  # frame 9 was not decoded
    assert set(kept[1:9] + kept[10:]) == {"reference"}


def test_keys_that_come_before_the_reference_positions_make_none_up(desk, context, annotate_files) -> None:
    rows = [f"a.mp4,0,{5 + t},{40.5 + t},70.5" for t in range(T)]
    annotate_files(reference="\n".join(["source,object,frame,x,y", *rows]) + "\n")
    on_their_way: list[Route] = []
    context.route("**/answer", lambda route: on_their_way.append(route))
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "d", "ArrowRight")
        expect(page.locator("#hint")).to_contain_text("on their way")
        on_their_way[0].continue_()
        expect(page.locator("#where")).to_contain_text("the reference position")
        press(page, "d", "ArrowRight")
        saved(page)
    assert corrections().index.tolist() == [("a", 0, 2)]


def test_keys_are_explained_and_everything_has_a_name(desk, context) -> None:
    with running(desk) as server:
        page = opened(context, server.url)
        press(page, "?")
        help_page = page.get_by_role("dialog", name="Keys")
        for words in ("next frame", "by 10 px", "interpolate between keys", "undo"):
            expect(help_page).to_contain_text(words)
        press(page, "d", "ArrowRight", "Escape")  # keys of the page do nothing under the help
        expect(help_page).to_be_hidden()
        expect(page.locator("#where")).to_contain_text("frame 0")
        assert not (ANNOTATIONS / "corrections.csv").exists()
        assert all(each.inner_text().strip() for each in page.get_by_role("button").all())
        cyrillic = "new KeyboardEvent('keydown', {key: 'в', code: 'KeyD', bubbles: true})"
        page.evaluate(f"document.body.dispatchEvent({cyrillic})")
        expect(page.locator("#where")).to_contain_text("frame 1 ")
        press(page, "n")
        expect(page.get_by_role("button", name="object 2")).to_have_attribute("aria-pressed", "true")
        page.set_viewport_size({"width": 380, "height": 700})
        assert page.evaluate("document.documentElement.scrollWidth") <= 380


@pytest.fixture
def evil_page(tmp_path: Path) -> Iterator[str]:
    """The address of another site's server in the same browser, with an empty page."""
    folder = tmp_path / "evil"
    folder.mkdir()
    (folder / "index.html").write_text("<title>evil</title>")
    handler = partial(http.server.SimpleHTTPRequestHandler, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


ATTACKS = {
    "script": "fetch(url + 'api/set').then(r => r.text())",
    "change": "fetch(url + 'api/clips/a', {method: 'PUT', headers: {'Content-Type': 'application/json'}, body})"
    ".then(r => r.text())",
    "picture": "new Promise((done, failed) => Object.assign(new Image(), "
    "{onload: done, onerror: () => failed('refused'), src: url + 'api/clips/a/frames/0'}))",
}


@pytest.mark.parametrize("attack", ATTACKS)
def test_another_site_in_the_same_browser_gets_nothing(desk, context, evil_page, attack) -> None:
    with running(desk) as server:
        page = context.new_page()
        page.goto(evil_page)
        lost = CorrectionRow(object=0, frame=0, x=None, y=None, visible=False, interpolated=False)
        nothing, wanted = ClipState(boxes=(), corrections=()), ClipState(boxes=(), corrections=(lost,))
        body = Change(place=desk.place, revision=nothing.revision, state=wanted).model_dump_json()
        outcome = page.evaluate(
            f"([url, body]) => {ATTACKS[attack]}.then(() => 'got through', error => String(error))", [server.url, body]
        )
        assert outcome != "got through"
        assert not ANNOTATIONS.exists()


def test_a_form_of_another_site_is_refused(desk, context, evil_page) -> None:
    with running(desk) as server:
        page = context.new_page()
        page.goto(evil_page)
        page.evaluate(
            "url => { const form = document.createElement('form'); form.method = 'POST'; form.action = url; "
            "document.body.append(form); form.submit() }",
            server.url + "api/clips/a/answer",
        )
        expect(page.locator("body")).to_contain_text("another origin are refused")


def test_a_foreign_name_for_this_machine_is_refused(desk, context) -> None:
    with running(desk) as server:
        page = context.new_page()
        answer = page.goto(f"http://{FOREIGN}:{server.port}/")
        assert answer is not None
        assert answer.status == 403
        assert "requests to another name are refused" in answer.text()
