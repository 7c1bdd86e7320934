"""What README says of one's own film, done as it stands there."""

import numpy as np
import pandas as pd
from pages import ROOT, blocks
from worlds import ball_film, encoded

FRAMES = 100


def test_from_one_s_own_film_to_the_report_by_the_commands_of_the_readme(clone, tmp_path):
    shown = [each.text for each in blocks(ROOT / "README.md", "sh", "Your own videos")]
    commands = next(text for text in shown if "~/film" in text)
    t = np.arange(FRAMES)[:, None]
    xy = np.stack([45 + 8 * np.sin(t / 25), 30 + 12 * np.sin(t / 12)], axis=-1)  # (T, 1, 2) pixels
    for name, seed in (("a.mkv", 3), ("b.mkv", 4)):
        encoded(tmp_path / "film" / name, ball_film(xy, 5.0, seed), t[:, 0] / 100)
    clone.run("env", f"HOME={tmp_path}", "bash", "-e", "-c", commands)
    tracks = pd.read_parquet(clone.root / "data/tracks/marbles.parquet")
    forecasts = pd.read_parquet(clone.root / "data/forecasts/marbles/tracks/dispnet.parquet")
    assert np.isfinite(tracks[["x", "y"]]).all(axis=1).any()
    assert np.isfinite(forecasts[["x", "y"]]).all(axis=None)
    assert len(forecasts) > 0
    assert "marbles" in (clone.root / "report/index.html").read_text(encoding="utf-8")
    assert not (clone.root / "data/clips/bowls").exists()  # nothing else is rebuilt for it
