"""What the page shows as the tracker's answer is what `ground_truth` would start from."""

import numpy as np

from physpipe.annotator.answers import Answers
from physpipe.baselines.ground_truth import ground_truth
from physpipe.baselines.template import TemplateParams
from physpipe.core.params import read
from physpipe.io import annotations, tracks

TEMPLATES = "clip,object,frame,x,y,w,h\na,0,0,3,6,15,15\na,1,20,15,28,15,15\n"
REFERENCE = "source,object,frame,x,y\na.mp4,1,7,60.5,70.5\na.mp4,1,8,0,0\n"


def both(clips, folder) -> tuple[np.ndarray, dict]:
    """(T, K, 2) of the truth of clip `a`, and the answers."""
    params = read("ground_truth", TemplateParams)
    given = annotations.load(folder, clips)
    return tracks.positions(ground_truth(clips, given, params), "a"), Answers(clips, params).of("a", given)


def test_boxes_are_answered_by_the_template_tracker(clips, annotate_files):
    truth, answers = both(clips, annotate_files(templates=TEMPLATES))
    assert sorted(answers) == [0, 1]
    for k, answer in answers.items():
        np.testing.assert_array_equal(answer.xy, truth[:, k])
    assert np.isfinite(truth).all()


def test_reference_positions_go_before_boxes(clips, annotate_files):
    truth, answers = both(clips, annotate_files(templates=TEMPLATES, reference=REFERENCE))
    assert sorted(answers) == [1]
    np.testing.assert_array_equal(answers[1].xy, truth[:, 1])
    assert np.flatnonzero(answers[1].score).tolist() == [2]  # frame 3 of the clip is beyond the crop


def test_an_answer_is_worked_out_once(clips, annotate_files, monkeypatch):
    params, given = read("ground_truth", TemplateParams), annotations.load(annotate_files(templates=TEMPLATES), clips)
    answers = Answers(clips, params)
    first = answers.of("a", given)
    monkeypatch.setattr(Answers, "_track", None)
    assert answers.of("a", given)[1] is first[1]
