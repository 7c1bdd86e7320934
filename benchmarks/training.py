"""Times the training of predictors on the data sets of the last `dvc repro`; prints it and keeps it.

    python benchmarks/training.py bowls bowls2

Minutes that each training takes as params.yaml has it, but for precision and threads: STEPS of its steps are timed, and
its validations left out. Shows what bfloat16 and a second thread are worth. Writes benchmarks/training.json.
"""

import json
import sys
import time
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import torch
from speed import processor

from physpipe.core.determinism import ComputeParams, device, prepare
from physpipe.core.horizon import PredictParams
from physpipe.core.params import read, read_value
from physpipe.core.precision import has_bfloat16
from physpipe.io import tracks
from physpipe.io.clips import ClipSet
from physpipe.learning.training import fit
from physpipe.predictor_learning.predicting import LearnedParams, learned_params, predictor_class
from physpipe.predictor_learning.windows import TrackWindows

OUT = Path(__file__).with_name("training.json")
WARM, STEPS = 4, 40
PRECISIONS = ("float32", "bfloat16") if has_bfloat16() else ("float32",)
THREADS = {"": 1, ", 2 threads": 2}


def windows(name: str, predict: PredictParams, params: LearnedParams) -> TrackWindows:
    """What it learns from."""
    kind = predictor_class(params.kind)
    last = predict.last_frame(params.trained_to, f"datasets.{name}.predict")
    table = tracks.load(Path(f"data/tracks/{name}.parquet"))
    clips = ClipSet(Path("data/clips") / name)
    return TrackWindows(clips, table, "train", kind.seen_frames, last, kind.sees_end, kind.steadies, predict.mirrors)


def minutes(params: LearnedParams, found: TrackWindows, precision: str, threads: int, seed: int) -> float:
    """A whole training's, by the seconds of a few steps; one that begins otherwise does for the same share of them."""
    prepare(ComputeParams(seed=seed, threads=threads))
    seconds = 0.0
    for steps in (WARM, STEPS):
        model = params.model.model_dump()
        if "matched_steps" in model:
            model["matched_steps"] = round(model["matched_steps"] * steps / params.fit.steps)
        net = predictor_class(params.kind)(type(params.model)(**model), found.objects)
        short = params.fit.model_copy(update={"steps": steps, "valid_every": steps, "precision": precision})
        with TemporaryDirectory() as folder:
            start = time.perf_counter()
            fit(
                net,
                lambda generator: found.draw(params.fit.batch_size, params.windows, generator),
                lambda: (0.0,),
                short,
                seed,
                Path(folder) / "training.pt",
                f"{steps} steps",
            )
            seconds = time.perf_counter() - start
    return round(seconds / STEPS * params.fit.steps / 60, 2)


def main(names: list[str]) -> None:
    """Measures all predictors on the data sets `names`; those measured before on the same machine are kept."""
    machine = f"{processor()}, {device()}, torch {torch.__version__}"
    kept = json.loads(OUT.read_text()) if OUT.is_file() else {}
    new: dict[str, Any] = {"machine": machine, "minutes": {}}
    table = kept if kept.get("machine") == machine else new
    table |= {"date": date.today().isoformat()}
    seed = read("compute", ComputeParams).seed
    for name in names:
        rows = table["minutes"].setdefault(name, {})
        predict = read(f"datasets.{name}.predict", PredictParams)
        for predictor in read_value("predictors"):
            kind = predictor_class(read_value(f"predictors.{predictor}.kind"))
            params = read(f"predictors.{predictor}", learned_params(kind)).on(predict)
            if params.trained_to == "interpolation" and predict.interpolation is None:
                continue
            found = windows(name, predict, params)
            rows[predictor] = {
                f"{precision}{also}": minutes(params, found, precision, threads, seed)
                for precision in PRECISIONS
                for also, threads in THREADS.items()
            }
            print(f"| {name} | {predictor} | " + " | ".join(f"{each} min" for each in rows[predictor].values()) + " |")
        OUT.write_text(json.dumps(table, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
