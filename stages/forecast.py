"""Forecast the test clips from their first frames with a trained predictor."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.determinism import ComputeParams, prepare
from physpipe.core.horizon import PredictParams
from physpipe.core.params import read, read_value
from physpipe.io import forecasts, tracks
from physpipe.io.clips import ClipSet
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictor_learning.predicting import load_predictor


def main(name: str, predictor: str, clips: Path, found: Path, model: Path, out: Path) -> None:
    """Writes forecasts of frames T0 to 4 T, or to each clip's end, or to the end that is seen, to the table `out`."""
    predict = read(f"datasets.{name}.predict", PredictParams)
    prepare(read("compute", ComputeParams))
    table = tracks.load(found)
    learned = load_predictor(model, predictor, tracks.object_count(found, table))
    end = predict.last_frame(read_value(f"predictors.{predictor}.trained_to"), f"datasets.{name}.predict")
    made = forecast(learned, ClipSet(clips), table, "test", predict.horizon, predictor, end)
    print(f"{predictor}: {made.skipped} clips left out, an object is lost in their first frames")
    forecasts.save(out, made.table, predictor, learned.seen_frames, predict.horizon)


if __name__ == "__main__":
    run(main)
