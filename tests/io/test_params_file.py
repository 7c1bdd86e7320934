"""A section more in params.yaml, every other byte kept."""

import pytest
import yaml

from physpipe.core.errors import InputError
from physpipe.io.params_file import with_item, with_section

TEXT = """\
# numbers of the whole project
run:
  datasets:
  - bowls   # simulated
  learned: [disp, prob]  # any of [1]

datasets:
  # film of a pendulum
  pendulum:
    ingest:
      fps: null     # frames/s; null: all
      crop:         # box; null: centred square
        left: 3     # pixels
        width: 5
      rate: 1e-5

    motion:
      objects: 1
# ------- trackers -------
tracker:
  kinds: []
"""


def test_the_new_section_is_the_template_but_for_the_changes() -> None:
    changes = {"ingest.fps": 80.0, "ingest.crop": None, "motion.objects": 2}
    text = with_section(TEXT, "datasets", "pendulum", "rink", changes)
    sections = yaml.safe_load(text)["datasets"]
    assert sections["rink"] == {"ingest": {"fps": 80.0, "crop": None, "rate": "1e-5"}, "motion": {"objects": 2}}
    assert sections["pendulum"] == yaml.safe_load(TEXT)["datasets"]["pendulum"]
    assert "fps: 80.0     # frames/s; null: all" in text


def test_every_other_line_stays_as_it_was() -> None:
    text = with_section(TEXT, "datasets", "pendulum", "rink", {})
    added = text[text.index("  rink:") : text.index("# ------- trackers")]
    assert text.replace(added, "") == TEXT
    assert text.index("  rink:") > text.index("      objects: 1")


def test_a_section_that_exists_stays_as_it_is() -> None:
    once = with_section(TEXT, "datasets", "pendulum", "rink", {"ingest.fps": 80.0})
    assert with_section(once, "datasets", "pendulum", "rink", {"ingest.fps": 30.0}) == once


def test_the_template_may_be_the_files_end() -> None:
    text = "datasets:\n  pendulum:\n    a: 1"
    assert yaml.safe_load(with_section(text, "datasets", "pendulum", "rink", {"a": 2})) == {
        "datasets": {"pendulum": {"a": 1}, "rink": {"a": 2}}
    }


def test_absent_templates_and_keys_are_refused() -> None:
    with pytest.raises(InputError, match=r"no section `datasets\.bowls`"):
        with_section(TEXT, "datasets", "bowls", "rink", {})
    with pytest.raises(InputError, match="no section `sets`"):
        with_section(TEXT, "sets", "pendulum", "rink", {})
    with pytest.raises(InputError, match=r"has no key `ingest\.fsp`"):
        with_section(TEXT, "datasets", "pendulum", "rink", {"ingest.fsp": 1})


@pytest.mark.parametrize("where", ["run.datasets", "run.learned", "tracker.kinds"])
def test_an_item_is_added_to_lists_of_any_style_once(where: str) -> None:
    outer, key = where.split(".")
    once = with_item(TEXT, where, "rink")
    assert yaml.safe_load(once)[outer][key] == [*yaml.safe_load(TEXT)[outer][key], "rink"]
    assert with_item(once, where, "rink") == once
    assert "- bowls   # simulated" in once
