"""The page stands alone, and its tables hold the metrics' numbers."""

import base64
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import cv2
import numpy as np
import pytest

from physpipe.io import tracks
from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS
from physpipe.report.page import write_page
from physpipe.report.paper import predictor_rows, tracker_rows

VOID = {"meta", "link", "img", "br", "input"}


class Page(HTMLParser):
    """Sources, alarms, cells by section and row, and whether tags nest."""

    def __init__(self, html: str):
        super().__init__()
        self.sources: list[str] = []
        self.alarms = 0
        self.numbers: dict[str, dict[str, list[str]]] = {}
        self.text: dict[str, str] = {}
        self._open: list[str] = []
        self._section = self._row = ""
        self.feed(html)
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in VOID:
            self._open.append(tag)
        self.sources += [given[key] for key in ("src", "href") if key in given]
        self.alarms += given.get("class") == "alarm"
        if tag == "section":
            self._section = given["id"]
        if tag == "tr":
            self._row = f"{len(self.numbers.get(self._section, {}))} {given.get('class', '')}".strip()
        if tag == "data":
            self.numbers.setdefault(self._section, {}).setdefault(self._row, []).append(given["value"])

    def handle_endtag(self, tag):
        assert self._open.pop() == tag
        if tag == "section":
            self._section = ""

    def handle_data(self, data):
        self.text[self._section] = self.text.get(self._section, "") + data


@pytest.fixture(scope="module")
def html(folder) -> str:
    return (folder / "index.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(html) -> Page:
    return Page(html)


def test_page_fetches_nothing(html, page):
    assert all(source.startswith(("data:", "#")) for source in page.sources)
    markup = re.sub(r"data:[a-z0-9/]+;base64,[A-Za-z0-9+/=]+", "", html)
    assert not re.search(r"https?://|url\(|@import|\bimport\b|fetch\(|<script[^>]+src", markup)
    assert "default-src 'none'" in html  # nor could it


def test_every_picture_decodes(page):
    kinds = []
    for source in page.sources:
        if source.startswith("data:") and source != "data:,":
            kind, content = source.split(";base64,")
            kinds.append(kind)
            raw = base64.b64decode(content, validate=True)
            assert cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR) is not None
    stills, panels, heat_maps = 2 * 2 * 3, 2 * 4, 2 * 3  # of two data sets: clips, frames; predictors; columns
    assert kinds == ["data:image/webp"] * (stills + panels + heat_maps)


def test_the_films_are_inside_with_every_clip_that_a_link_names(html, page, project):
    data = json.loads(re.search(r'<script type="application/json" id="report-data">(.*?)</script>', html)[1])
    assert set(data["films"]) == {"bowls", "film"}
    scenes = {scene["clip"]: scene for film in data["films"].values() for scene in film["scenes"]}
    assert len(scenes["bowls_003"]["times_s"]) == project.world.frames
    links = [source.removeprefix("#at=").split("/") for source in page.sources if source.startswith("#at=")]
    assert len(links) == 2 * (2 * 3 + 3)  # data sets, stills and doubtful spans
    for name, clip, frame in links:
        assert clip in {scene["clip"] for scene in data["films"][name]["scenes"]}
        assert 0 <= int(frame) < scenes[clip]["total"]


def test_tables_hold_the_numbers_of_the_metrics(page, bowls):
    shown = {number for row in page.numbers["bowls"].values() for number in row}
    blocks = [
        (tracker_rows(bowls), TRACKER_COLUMNS),
        *((rows, PREDICTOR_COLUMNS) for rows in predictor_rows(bowls).values()),
    ]
    for rows, columns in blocks:
        for row in rows.values():
            for key in row.keys() & columns.keys():
                assert str("" if row[key] is None else row[key]) in shown
                if f"paper_{key}" in row:
                    assert str(row[f"paper_{key}"]) in shown


def test_headline_row_has_ours_the_papers_and_persistence(page, bowls):
    ours = str(bowls.predictors["tracks"]["dispnet"]["error_T_px"])
    assert [ours, "3.9", "40.0"] in page.numbers[""].values()


def test_only_the_unlocked_set_raises_the_alarm(page):
    assert page.alarms == 2  # at the top of the page and of the set's section
    assert "locked: false" in page.text["film"]
    assert "locked: false" not in page.text["bowls"]


def test_what_is_simulated_and_what_has_no_truth_is_said(page):
    assert "Simulated" in page.text["bowls"]
    assert "No truth: nobody annotated this film" in page.text["film"]
    assert "No truth" not in page.text["bowls"]
    assert "Simulated" not in page.text["film"]


def test_other_runs_are_not_shown(page):
    assert "old" not in page.text
    assert "vin" not in {row.split()[-1] for row in page.numbers["bowls"]}


def test_same_inputs_give_the_same_bytes(project, folder, tmp_path):
    write_page(tmp_path / "report", project.every(), project.ablation, 7, project.shown, project.lock)
    assert (tmp_path / "report" / "index.html").read_bytes() == (folder / "index.html").read_bytes()


def test_ablation_shows_what_was_measured_and_what_has_not_run(page, html):
    rows = page.numbers["ablation"].values()
    assert ["1.5", "4.0", "0.0", "True"] in rows
    assert ["", "", "", ""] in rows  # a seed of `disc` has not run
    assert "worst 2.50" in page.text["ablation"]
    assert "bowlr_sim" in page.text["ablation"]
    assert "Our recipe less one" not in page.text["ablation"]  # none of its rows has run
    assert "rank correlation" not in page.text["ablation"]


def test_a_set_without_any_track_says_so(project, film, tmp_path):
    lost = replace(film, track=tracks.empty())
    write_page(tmp_path / "report", [lost], {}, 7, project.shown, project.lock)
    assert "No track, so nothing to show" in (tmp_path / "report" / "index.html").read_text()


def test_the_verdict_stands_beside_its_bounds(page):
    for name in ("bowls", "film"):
        assert "at most 3" in page.text[name]
        assert ("missed" in page.text[name]) == (name == "film")  # whose heat maps are flatter than that


def test_models_have_one_spelling(page):
    words = " ".join(text for section, text in page.text.items() if section)  # the script keeps names as they are
    assert "lucas kanade" in words
    assert not re.search(r"lucas_kanade|(median|knn|mog2)_blob", words)


def test_one_training_is_not_called_several(project, bowls, tmp_path):
    texts = {}
    for detectors in (1, 2):
        each = replace(bowls, signals=bowls.signals * detectors, heat_maps=[])
        write_page(tmp_path / str(detectors), [each], {}, 7, project.shown, project.lock)
        texts[detectors] = (tmp_path / str(detectors) / "index.html").read_text()
    assert "a training for each further object" not in texts[1]
    assert "a training for each further object" in texts[2]
