"""Learning a predictor from tracks, keeping it in a file, and taking it out again."""

from pathlib import Path

import pandas as pd
import torch
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.io import checkpoints, results
from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams, fit
from physpipe.predictor_learning.windows import TrackWindows, WindowParams
from physpipe.predictors import PREDICTORS
from physpipe.predictors.base import Predictor

WEIGHTS, CURVE = "weights.pt", "curve.csv"


def predictor_class(name: str) -> type[Predictor]:
    """The class of that name; raises InputError for an unknown one."""
    if name not in PREDICTORS:
        raise InputError(name, "no such predictor", f"use one of {', '.join(PREDICTORS)}")
    return PREDICTORS[name]


def learn_predictor(
    name: str,
    params: tuple[Section, FitParams, WindowParams],
    clips: ClipSet,
    table: pd.DataFrame,
    horizon: int,
    seed: int,
    checkpoint: Path,
) -> tuple[Predictor, pd.DataFrame]:
    """The predictor with the weights that forecast the validation clips best, and its learning curve.

    `params`: of the model, of the fit, of the windows. Raises InputError when no window can be learned from.
    """
    kind = predictor_class(name)
    model_params, fit_params, window_params = params
    train = TrackWindows(clips, table, "train", kind.seen_frames, horizon)
    valid = TrackWindows(clips, table, "valid", kind.seen_frames, horizon)
    print(f"{name}: {len(train)} windows to learn from; {train.skipped} left out, an object is lost in them")
    predictor = kind(model_params, train.objects)
    checked = valid.evenly(window_params.valid_windows).tolist()
    stretches = [checked[i : i + fit_params.batch_size] for i in range(0, len(checked), fit_params.batch_size)]

    def validate() -> float:
        return sum(len(each) * _error_px(predictor, valid, each) for each in stretches) / len(checked)

    curve = fit(
        predictor,
        lambda generator: train.draw(fit_params.batch_size, window_params, generator),
        validate,
        fit_params,
        seed,
        checkpoint,
        name,
    )
    return predictor, curve


def _error_px(predictor: Predictor, windows: TrackWindows, numbers: list[int]) -> float:
    """Mean distance from the tracks at frame T."""
    batch = windows.batch(numbers)
    last = predictor(batch.seen, batch.asked_times[:, -1:]).mean
    return torch.linalg.vector_norm(last - batch.target[:, -1:], dim=-1).mean().item()


def save_predictor(folder: Path, name: str, predictor: Predictor, params: Section, curve: pd.DataFrame) -> None:
    """Writes weights.pt (with all that builds the model again) and curve.csv."""
    content = {
        "predictor": name,
        "params": params.model_dump(),
        "objects": predictor.objects,
        "state": predictor.cpu().state_dict(),
    }
    checkpoints.save(folder / WEIGHTS, content)
    results.save_csv(folder / CURVE, curve)


def load_predictor(folder: Path, name: str, objects: int) -> Predictor:
    """The saved predictor; raises InputError when it is another one, or for another number of objects."""
    path = folder / WEIGHTS
    content = checkpoints.load(path)
    again = "run `dvc repro` to train it again"
    if content.get("predictor") != name:
        raise InputError(path, f"holds `{content.get('predictor')}`, not `{name}`", again)
    if content["objects"] != objects:
        raise InputError(path, f"learned {content['objects']} objects; the tracks have {objects}", again)
    kind = predictor_class(name)
    try:
        params = kind.Params.model_validate(content["params"])
    except ValidationError as error:
        raise InputError(path, f"params of another model ({error})", again) from None
    predictor = kind(params, objects)
    checkpoints.load_into(predictor, content["state"], path)
    return predictor
