import pytest

from physpipe.core.errors import InputError
from physpipe.core.horizon import PredictParams

SECTION = "datasets.bowls.predict"


def test_a_training_reaches_the_frame_that_it_is_told_to():
    predict = PredictParams(horizon=20, interpolation=40, mirrors=True)
    assert predict.last_frame("horizon", SECTION) == 20
    assert predict.last_frame("interpolation", SECTION) == 40


def test_a_set_without_an_interpolation_says_which_key_is_empty():
    predict = PredictParams(horizon=10, interpolation=None, mirrors=True)
    assert predict.last_frame("horizon", SECTION) == 10
    with pytest.raises(InputError, match=r"`datasets\.bowls\.predict\.interpolation`: is empty"):
        predict.last_frame("interpolation", SECTION)
