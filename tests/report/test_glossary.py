"""Words that need explaining are explained when, and only when, the page has them."""

import re

from physpipe.report.glossary import COLUMN_MEANINGS, LOSS_MEANINGS, LOSSES, glossary
from physpipe.report.headlines import PREDICTOR_COLUMNS, TRACKER_COLUMNS


def test_everything_explained_is_something_that_the_page_can_have():
    assert COLUMN_MEANINGS.keys() <= TRACKER_COLUMNS.keys() | PREDICTOR_COLUMNS.keys()
    assert LOSS_MEANINGS.keys() <= LOSSES.keys()


def test_only_what_is_there_is_explained():
    assert glossary({"mean_px"}, {"train"}) == []
    assert [term.word for term in glossary({"hota", "skill_T"}, set())] == ["HOTA", "skill at T"]
    assert [term.word for term in glossary(set(), {"motion_nats"})] == ["start, rest", "motion, nats"]


def test_the_page_ends_with_its_words_and_its_tables_lead_there(folder):
    html = (folder / "index.html").read_text()
    words = re.search(r'<section id="words".*?</section>', html, re.DOTALL)[0]
    told = re.findall(r"<dt>(.*?)</dt>", words)
    assert told[-2:] == ["start, rest", "entropy of the heat map, nats"]
    assert {"off track", "skill at T", "locked"} <= set(told)
    assert "HOTA" not in told
    assert html.count('href="#words"') == 2  # the tables of trackers and of predictors, of the one set with truth
