"""Forecast the test clips with the extrapolators that learn nothing."""

from pathlib import Path

from physpipe.core.command import run
from physpipe.core.horizon import BASELINES, PredictParams
from physpipe.core.params import read
from physpipe.io import forecasts, tracks
from physpipe.io.clips import ClipSet
from physpipe.predictor_learning.forecasting import forecast
from physpipe.predictors import PREDICTORS
from physpipe.predictors.polynomial import NoParams


def main(name: str, clips: Path, found: Path, out: Path) -> None:
    """Writes a forecast table for each of them to the folder `out`."""
    predict = read(f"datasets.{name}.predict", PredictParams)
    table = tracks.load(found)
    for each in BASELINES:
        predictor = PREDICTORS[each](NoParams(), tracks.object_count(found, table))
        made = forecast(predictor, ClipSet(clips), table, "test", predict.horizon, each)
        print(f"{each}: {made.skipped} clips left out, an object is lost in their first frames")
        forecasts.save(out / f"{each}.parquet", made.table, each, predictor.seen_frames, predict.horizon)


if __name__ == "__main__":
    run(main)
