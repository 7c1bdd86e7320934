"""Learning a predictor from tracks, keeping it in a file, and taking it out again."""

from pathlib import Path
from typing import Generic, Self, TypeVar

import pandas as pd
import torch
from pydantic import ValidationError

from physpipe.core.errors import InputError
from physpipe.core.horizon import PredictParams, TrainedTo
from physpipe.core.params import Section
from physpipe.io import checkpoints, results
from physpipe.io.clips import ClipSet
from physpipe.learning.training import FitParams, Rank, fit
from physpipe.predictor_learning.windows import TrackWindows, WindowParams
from physpipe.predictors import PREDICTORS
from physpipe.predictors.base import Predictor

WEIGHTS, CURVE = "weights.pt", "curve.csv"


Model = TypeVar("Model", bound=Section)


def predictor_class(kind: str) -> type[Predictor]:
    """The class of that kind; raises InputError for an unknown one."""
    if kind not in PREDICTORS:
        raise InputError(kind, "no such kind of predictor", f"use one of {', '.join(PREDICTORS)}")
    return PREDICTORS[kind]


class LearnedParams(Section, Generic[Model]):
    """One section of `predictors`: what it is, how far it learns to forecast, and how."""

    kind: str
    """Key of PREDICTORS."""
    trained_to: TrainedTo
    """How far its training reaches: to the data set's `predict.horizon`, or to its `predict.interpolation`."""
    model: Model
    windows: WindowParams
    fit: FitParams

    def on(self, predict: PredictParams) -> Self:
        """As it learns a set of that section: no forecast is a mean over mirrors of film that could not be mirrored."""
        if predict.mirrors or "symmetric" not in type(self.model).model_fields:
            return self
        return self.model_copy(update={"model": self.model.model_copy(update={"symmetric": False})})


def learned_params(kind: type[Predictor]) -> type[LearnedParams]:
    """The section's class for that class of predictors."""
    return LearnedParams[kind.Params]  # type: ignore[name-defined]


def learn_predictor(
    name: str,
    params: LearnedParams,
    clips: ClipSet,
    table: pd.DataFrame,
    last_frame: int,
    mirrors: bool,
    seed: int,
    checkpoint: Path,
) -> tuple[Predictor, pd.DataFrame]:
    """The predictor with the weights that forecast the validation clips best, and its learning curve.

    `last_frame`: the last one that it learns to forecast; `mirrors`: whether it learns from mirrored film, too. Raises
    InputError when no window can be learned from.
    """
    kind = predictor_class(params.kind)
    train = TrackWindows(clips, table, "train", kind.seen_frames, last_frame, kind.sees_end, kind.steadies, mirrors)
    valid = TrackWindows(clips, table, "valid", kind.seen_frames, last_frame, kind.sees_end)
    print(f"{name}: {len(train)} windows to learn from; {train.skipped} left out, an object is lost in them")
    predictor = kind(params.model, train.objects)
    predictor.watch([torch.from_numpy(path) for path in train.camera or []])
    checked = valid.evenly(params.windows.valid_windows).tolist()
    size = params.fit.batch_size
    stretches = [checked[i : i + size] for i in range(0, len(checked), size)]

    def validate() -> Rank:
        losses = [len(each) * predictor.validation_loss(valid.batch(each)).item() for each in stretches]
        return (sum(losses) / len(checked),)

    curve = fit(
        predictor,
        lambda generator: train.draw(size, params.windows, generator),
        validate,
        params.fit,
        seed,
        checkpoint,
        name,
    )
    calibrate(predictor, clips, table, valid, params.windows.valid_windows)
    return predictor, curve


@torch.no_grad()
def calibrate(predictor: Predictor, clips: ClipSet, table: pd.DataFrame, valid: TrackWindows, count: int) -> None:
    """Fits how sure it is, once all else is learned, to the `count` validation windows that begin soonest."""
    far = valid if predictor.sees_end else _twice_as_far(valid, clips, table)
    predictor.calibrate(far.batch(far.early(count).tolist()))


def _twice_as_far(valid: TrackWindows, clips: ClipSet, table: pd.DataFrame) -> TrackWindows:
    """The validation windows to 2 T, where clips are as long and tracked: how sure to be there has to be seen, too."""
    try:
        return TrackWindows(clips, table, "valid", valid.seen_frames, 2 * valid.horizon)
    except InputError:
        return valid


def save_predictor(folder: Path, name: str, predictor: Predictor, params: LearnedParams, curve: pd.DataFrame) -> None:
    """Writes weights.pt and curve.csv."""
    save_weights(folder, name, predictor, params)
    results.save_csv(folder / CURVE, curve)


def save_weights(folder: Path, name: str, predictor: Predictor, params: LearnedParams) -> None:
    """Writes weights.pt, with all that builds the model again."""
    content = {
        "predictor": name,
        "kind": params.kind,
        "params": params.model.model_dump(),
        "objects": predictor.objects,
        "state": predictor.cpu().state_dict(),
    }
    checkpoints.save(folder / WEIGHTS, content)


def load_predictor(folder: Path, name: str, objects: int) -> Predictor:
    """The saved predictor; raises InputError when it is another one, or for another number of objects."""
    path = folder / WEIGHTS
    content = checkpoints.load(path)
    again = "run `dvc repro` to train it again"
    if content.get("predictor") != name:
        raise InputError(path, f"holds `{content.get('predictor')}`, not `{name}`", again)
    if content["objects"] != objects:
        raise InputError(path, f"learned {content['objects']} objects; the tracks have {objects}", again)
    kind = predictor_class(content["kind"])
    try:
        params = kind.Params.model_validate(content["params"])
    except ValidationError as error:
        raise InputError(path, f"params of another model ({error})", again) from None
    predictor = kind(params, objects)
    checkpoints.load_into(predictor, content["state"], path)
    # As it learned: convolutions of another layout round otherwise
    return predictor.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
