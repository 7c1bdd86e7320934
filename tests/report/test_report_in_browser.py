"""The page in a real browser: it plays, seeks, filters, sorts, reads values out, and fits a phone and paper."""

import base64
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pandas as pd
import pytest
from playwright.sync_api import Browser, Locator, Page, expect, sync_playwright

from physpipe.report import colours
from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS
from physpipe.report.page import write_page

expect.set_options(timeout=30_000)  # a busy machine is slow, not wrong
DESKTOP, PHONE = {"width": 1200, "height": 800}, {"width": 390, "height": 844}

ROUND = """(late) => {
    const player = document.querySelector(".player");
    let ended = false;
    new MutationObserver(() => {
        if (Number(player.dataset.frame) > late) ended = true;
        else if (ended) document.documentElement.dataset.round = "yes";
    }).observe(player, { attributes: true });
}"""
"""Notes when the first player has come to the end of its clip and begun again."""


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def opened(browser: Browser, folder: Path) -> Iterator[Any]:
    """Opens the page from disk; complaints on the console and requests for anything outside it fail the test."""
    wrong: list[str] = []
    contexts = []

    def opened(at: str = "", page_folder: Path = folder, viewport: dict = DESKTOP, **kind: Any) -> Page:
        contexts.append(browser.new_context(viewport=viewport, offline=True, **kind))
        page = contexts[-1].new_page()
        page.on("console", lambda message: wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda asked: None if asked.url.startswith(("file:", "data:")) else wrong.append(asked.url))
        page.goto((page_folder / "index.html").as_uri() + at)
        expect(page.locator("html")).to_have_attribute("data-started", "yes")
        expect(page.locator(".player[data-ready=yes]")).to_have_count(page.locator(".player").count())
        return page

    yield opened
    for context in contexts:
        context.close()
    assert wrong == []


def player(page: Page, name: str = "bowls") -> Locator:
    return page.locator(f".player[data-film={name}]")


def press(page: Page, *keys: str) -> None:
    for key in keys:
        page.keyboard.press(key)


def at(film: Locator, clip: str, frame: int) -> None:
    expect(film).to_have_attribute("data-clip", clip)
    expect(film).to_have_attribute("data-frame", str(frame))


def picture(film: Locator) -> np.ndarray:
    """(height, width, 3) of what the canvas shows."""
    address = film.locator("canvas").evaluate("canvas => canvas.toDataURL()")
    raw = base64.b64decode(address.removeprefix("data:image/png;base64,"))
    return cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]


def colour_at(film: Locator, xy: np.ndarray, width: int) -> np.ndarray:
    """The canvas's colour at a position in clip pixels."""
    shown = picture(film)
    x, y = np.round((xy + 0.5) * shown.shape[1] / width - 0.5).astype(int)
    return shown[y, x].astype(int)


def numbers(table: Locator, column: int) -> list[str]:
    cells = table.locator(f"tbody tr:visible > :nth-child({column + 1})")
    return [cell.evaluate("cell => cell.querySelector('data')?.value ?? cell.textContent") for cell in cells.all()]


def test_everything_on_the_page_loads(opened):
    page = opened()
    broken = page.evaluate("[...document.images].filter((each) => !(each.complete && each.naturalWidth > 0)).length")
    assert (page.locator("img").count() > 10, broken) == (True, 0)
    expect(page.locator(".chart:visible")).to_have_count(1 + 2 + 2 + 2 + 2 + 2 + 2)  # bowls: all; film: learning alone
    assert page.locator(".chart:visible path.line").count() > 20
    for name in ("bowls", "film"):
        assert picture(player(page, name)).std() > 5  # grey levels; nothing drawn is 0


def test_a_frame_stands_under_its_own_marks(opened, bowls, project):
    page, width = opened(), project.world.width
    film = player(page)
    film.focus()
    press(page, "1", "2", "3", "4", "5")  # no layer but the film
    clip = bowls.clips.frames("bowls_003")
    for frame in (0, 9):
        press(page, "Home", *["ArrowRight"] * frame)
        at(film, "bowls_003", frame)
        shown = picture(film)
        rows, columns = (np.arange(side) for side in clip.shape[1:3])
        zoom = shown.shape[1] / width
        spots = shown[np.ix_(((rows + 0.5) * zoom).astype(int), ((columns + 0.5) * zoom).astype(int))]
        away = np.abs(spots.astype(float) - clip[frame]).mean(axis=2)
        assert np.median(away) < 15  # grey levels: the film is noise, which the codec smooths
        x, y = bowls.truth[(bowls.truth["clip"] == "bowls_003") & (bowls.truth["frame"] == frame)][["x", "y"]].iloc[0]
        assert colour_at(film, np.array([x, y]), width)[0] > 140  # the ball is red, the ground below 110


def test_layers_are_switched_by_box_and_by_key(opened, bowls, project):
    page, world = opened(), project.world
    film = player(page)
    film.focus()
    press(page, "End")
    last = world.frames - 1
    at(film, "bowls_003", last)
    dot = bowls.track[(bowls.track["clip"] == "bowls_003") & (bowls.track["frame"] == last)][["x", "y"]].iloc[0]
    near = lambda: np.abs(colour_at(film, dot.to_numpy(), world.width) - colours.rgb(colours.of_object(0))).max() < 30  # noqa: E731
    press(page, "3")  # the trail has the dot's colour
    assert near()
    press(page, "2")
    expect(film.get_by_label("track")).not_to_be_checked()
    assert not near()
    film.get_by_label("track").check()
    assert near()
    film.get_by_label("trail").check()
    boxes = [film.locator(f"[name={layer}]") for layer in ("truth", "track", "trail", "forecast", "ellipse")]
    before = picture(film)
    for box in boxes:
        box.uncheck()
        after = picture(film)
        assert (before != after).any(), box
        before = after
    expect(player(page, "film").locator("[name=truth]")).to_have_count(0)  # nobody annotated it


def test_the_player_shows_any_predictors_forecast(opened, bowls, project):
    page, world = opened(), project.world
    film = player(page)
    frame = world.seen + 2

    def drawn(predictor: str) -> bool:
        table = bowls.forecasts[predictor]
        spot = table[(table["clip"] == "bowls_003") & (table["frame"] == frame)][["x", "y"]].iloc[0]
        away = np.abs(colour_at(film, spot.to_numpy(), world.width) - colours.rgb(colours.FORECAST))
        return bool(away.max() < 30)

    film.focus()
    press(page, "1", "2", "3", "5", *["ArrowRight"] * frame)  # the forecast alone
    menu = film.get_by_label("forecast of")
    assert menu.locator("option").all_inner_texts() == ["dispnet", "probnet", "persistence", "linear", "quadratic"]
    assert drawn("dispnet")
    assert not drawn("quadratic")
    for drift_px, name in ((2, "probnet"), (4, "persistence"), (5, "linear"), (6, "quadratic"), (1, "dispnet")):
        press(page, "p")
        expect(menu).to_have_value(name)
        assert drawn(name)
        expect(film.locator(".now")).to_contain_text(f"forecast off by {0.3 * 3 * drift_px:#.3g} px")  # 3 frames ahead
    menu.focus()
    press(page, "ArrowDown")  # the menu keeps its own keys
    expect(menu).to_have_value("probnet")
    at(film, "bowls_003", frame)
    ellipse = film.locator("[name=ellipse]")
    for name, has_ellipse in (("probnet", True), ("linear", False)):
        menu.select_option(name)
        without = picture(film)
        ellipse.check()
        assert (picture(film) != without).any() == has_ellipse, name
        ellipse.uncheck()
    film.locator(".clip").select_option(index=2)  # a training clip, which nobody forecasts
    expect(film.locator(".now")).to_contain_text("no forecast of linear")


def test_it_plays_pauses_and_seeks(opened, project):
    page = opened()
    film = player(page)
    film.focus()
    expect(film.locator(".speed")).to_have_value("0.5")  # 60 frames/s begin at no more than 30
    press(page, " ")
    expect(film).to_have_attribute("data-playing", "true")
    expect(film).not_to_have_attribute("data-frame", "0")
    press(page, " ")
    expect(film).to_have_attribute("data-playing", "false")
    press(page, "Home", "ArrowRight", "Shift+ArrowRight", "ArrowLeft")
    at(film, "bowls_003", 10)
    film.locator(".scrub").fill("7")
    at(film, "bowls_003", 7)
    expect(film.locator(".now")).to_contain_text(f"track off by {project.world.off_px:.2f} px")
    press(page, "End", "ArrowRight")
    at(film, "bowls_003", project.world.frames - 1)
    press(page, "ArrowDown")
    at(film, "bowls_004", 0)
    film.locator(".clip").select_option(index=0)
    at(film, "bowls_003", 0)
    press(page, "Tab")  # the selection keeps its own keys
    film.locator("[data-do=on]").click()
    at(film, "bowls_003", 1)


def test_playing_goes_round_at_the_films_own_pace(opened, project):
    page = opened()
    film = player(page)
    film.locator(".speed").select_option("2")
    film.locator("[data-do=play]").click()
    page.evaluate(ROUND, project.world.frames - 6)
    expect(page.locator("html")).to_have_attribute("data-round", "yes")
    expect(film).to_have_attribute("data-playing", "true")


def test_links_go_to_the_moment_again_and_again(opened, bowls):
    page = opened()
    film = player(page)
    link = page.locator("#bowls table.spans a").first
    clip, first = link.inner_text(), int(link.get_attribute("href").rsplit("/", 1)[1])
    for _ in range(2):
        link.click()
        at(film, clip, first)
        expect(film).to_be_focused()
        press(page, "End")
    page.locator("#bowls .sheet a").nth(4).click()
    still = page.locator("#bowls .sheet a").nth(4).get_attribute("href").split("/")
    at(film, still[1], int(still[2]))
    expect(film).to_be_in_viewport()


def test_an_address_with_a_moment_opens_there(opened, project):
    page = opened("#at=film/film_004/13")
    at(player(page, "film"), "film_004", 13)
    expect(player(page, "film")).to_be_in_viewport()
    assert opened("#at=film/unknown/13").locator(".player").count() == 2


def test_sets_and_models_are_filtered(opened):
    page = opened()
    page.get_by_label("show bowls").uncheck()
    expect(page.locator("#bowls")).to_be_hidden()
    expect(page.locator("tr[data-set=bowls]:visible")).to_have_count(0)
    expect(page.locator("#film")).to_be_visible()
    page.get_by_label("show bowls").check()
    errors = page.locator("[data-chart='bowls/tracker_errors']")
    expect(errors.locator(".plot path.line")).to_have_count(3)
    page.locator(".models summary").click()
    page.locator("[value='tracker:centre']").uncheck()
    expect(page.locator(".models output")).to_have_text(re.compile(r"^\d+ of \d+$"))
    expect(page.locator("tr[data-model='tracker:centre']:visible")).to_have_count(0)
    expect(page.locator("tr[data-model='tracker:unsupervised']:visible")).not_to_have_count(0)
    expect(errors.locator(".plot path.line")).to_have_count(2)
    page.locator(".choices fieldset").first.get_by_text("none").click()
    expect(errors).to_be_hidden()
    expect(page.locator("tr[data-model^='predictor:']:visible")).not_to_have_count(0)
    press(page, "Escape")
    expect(page.locator(".choices")).to_be_hidden()


def test_the_plate_and_what_is_claimed_follow_the_models(opened):
    page = opened()
    panels = page.locator("#plate [data-set=bowls] figure")
    cover = page.locator("[data-chart='bowls/coverage']")
    expect(panels.locator("visible=true")).to_have_count(4)
    expect(cover.locator(".chart").first.locator(".plot path.line")).to_have_count(3)  # two predictors and the claim
    page.locator(".models summary").click()
    page.locator("[value='predictor:dispnet']").uncheck()
    expect(panels.locator("visible=true")).to_have_count(3)
    expect(cover.locator(".chart").first.locator(".plot path.line")).to_have_count(2)
    page.locator("[value='predictor:probnet']").uncheck()
    expect(cover).to_be_hidden()
    page.get_by_label("show bowls").uncheck()
    expect(page.locator("#plate [data-set=bowls]")).to_be_hidden()
    expect(page.locator("#plate [data-set=film]")).to_be_visible()


def test_coverage_is_read_out_in_percent(opened):
    page = opened()
    chart = page.locator("[data-chart='bowls/coverage'] .chart").first
    chart.locator("svg[role=img]").focus()
    press(page, "End", "ArrowLeft")
    expect(chart.locator(".at")).to_have_text("90 % ellipse")
    expect(chart.locator("li", has_text="as claimed").locator("output")).to_have_text("90.0 %")
    expect(chart.locator("li", has_text="dispnet").locator("output")).to_have_text(re.compile(r"^\d+\.\d %$"))


def test_the_plate_needs_no_script(browser, folder):
    context = browser.new_context(java_script_enabled=False, offline=True)
    page = context.new_page()
    page.goto((folder / "index.html").as_uri())
    expect(page.locator("#plate img")).to_have_count(2 * 4)  # data sets, predictors
    expect(page.locator("#plate img").first).to_be_visible()
    context.close()


def test_tables_sort_both_ways_with_the_unknown_last(opened):
    page = opened()
    table = page.locator("#bowls table").nth(1)  # predictors from tracks
    expect(table.locator("caption")).to_contain_text("unsupervised tracks")
    for heading, count in (("at T px", 5), ("90 % coverage", 1)):
        place = [each.inner_text() for each in table.locator("thead th").all()].index(heading)
        button = table.locator("thead button").nth(place)
        for descending in (False, True):
            button.focus()
            press(page, "Enter")
            values = numbers(table, place)
            known = [float(each) for each in values if each]
            assert known == sorted(known, reverse=descending)
            assert values[: len(known)] == [each for each in values if each]
            assert len(known) == count
    expect(table.locator("th[aria-sort=descending]")).to_have_count(1)


def test_charts_read_out_their_values(opened, bowls):
    page = opened()
    chart = page.locator("[data-chart='bowls/horizons'] .chart").first
    chart.scroll_into_view_if_needed()
    box = chart.locator(".plot svg").bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.6, box["y"] + box["height"] / 2)
    expect(chart.locator(".at")).to_have_text(re.compile(r"^frame \d+$"))
    frame = int(chart.locator(".at").inner_text().removeprefix("frame "))
    table = bowls.horizons[(bowls.horizons["supervision"] == "tracks") & (bowls.horizons["frame"] == frame)]
    for name, error_px in table[["predictor", "error_px"]].itertuples(index=False):
        value = chart.locator("li", has_text=name).locator("output").inner_text()
        assert float(value) == pytest.approx(error_px, rel=6e-3)  # three digits
    expect(chart.locator(".cursor circle")).to_have_count(len(table))
    page.mouse.move(0, 0)
    expect(chart.locator(".at")).to_have_text("")
    chart.locator("svg[role=img]").focus()
    press(page, "Home", "ArrowRight")
    expect(chart.locator(".at")).to_have_text("frame 2")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_phone(opened, scheme):
    page = opened(viewport=PHONE, color_scheme=scheme, has_touch=True, is_mobile=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    for part in (".screen canvas", ".scrub", ".keys", ".clip"):
        box = player(page).locator(part).first.bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= PHONE["width"]
    player(page).locator("[data-do=on]").tap()
    at(player(page), "bowls_003", 1)
    page.locator(".models summary").tap()
    box = page.locator(".choices").bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= PHONE["width"]
    page.keyboard.press("Escape")
    still = page.locator("#short + .wide thead th").last.bounding_box()
    assert still["x"] + still["width"] <= PHONE["width"]  # a table that needs no scrolling
    expect(player(page).locator(".hints")).to_have_text(re.compile(r"^\s*Curve"), use_inner_text=True)  # no keys here
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", ground)[:3])) > 380) == (scheme == "light")


def test_ticks_at_the_edge_are_whole(opened, project, bowls, tmp_path):
    learning = pd.DataFrame({"model": "dispnet, tracks", "loss": "valid", "step": [200, 1200], "value": [2.0, 1.0]})
    write_page(tmp_path / "report", [replace(bowls, learning=learning)], {}, 7, project.shown, project.lock)
    page = opened(page_folder=tmp_path / "report", viewport=PHONE)
    plot = page.locator("[data-chart='bowls/predictor_learning'] .plot svg")
    tick, box = plot.get_by_text("1200", exact=True).bounding_box(), plot.bounding_box()
    assert box["x"] <= tick["x"]
    assert tick["x"] + tick["width"] <= box["x"] + box["width"]


def test_every_column_is_on_the_paper(opened, project, bowls, tmp_path):
    trackers = {name: {**dict.fromkeys(TRACKER_COLUMNS, 0.0123), **row} for name, row in bowls.trackers.items()}
    predictors = {
        each: {name: {**dict.fromkeys(PREDICTOR_COLUMNS, 0.0123), **row} for name, row in rows.items()}
        for each, rows in bowls.predictors.items()
    }
    full = replace(bowls, trackers=trackers, predictors=predictors)
    write_page(tmp_path / "report", [full], {}, 7, project.shown, project.lock)
    page = opened(page_folder=tmp_path / "report", viewport={"width": 688, "height": 974})  # A4 within its margins
    page.emulate_media(media="print")
    for table in page.locator("table").all():
        assert table.evaluate("table => table.offsetWidth - table.parentElement.clientWidth") <= 0


def test_paper_shows_stills_instead_of_players(opened):
    page = opened(color_scheme="dark")
    page.emulate_media(media="print")
    expect(player(page)).to_be_hidden()
    expect(page.locator(".filters")).to_be_hidden()
    expect(page.locator("#bowls .sheet img").first).to_be_visible()
    expect(page.locator("#plate img").first).to_be_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.pdf().startswith(b"%PDF")


def test_everything_is_reached_with_the_tab_key(opened):
    page = opened()
    reached = set()
    for _ in range(60):
        press(page, "Tab")
        reached.add(page.evaluate("document.activeElement.closest('.player, .filters, th, .plot, .sheet')?.className"))
        if page.evaluate("document.activeElement.closest('.plot') !== null"):
            break
    assert {"player", "filters", "sheet", "plot"} <= reached


def test_names_that_look_like_markup_stay_text(opened, project, bowls, tmp_path):
    """The JSON of the page cannot end its element, whatever a model is called."""
    hostile = "</script><b>"
    learning = bowls.learning.assign(model=hostile)
    write_page(tmp_path / "report", [replace(bowls, learning=learning)], {}, 7, project.shown, project.lock)
    page = opened(page_folder=tmp_path / "report")
    expect(page.locator("[data-chart='bowls/predictor_learning'] li").first).to_contain_text(hostile)
