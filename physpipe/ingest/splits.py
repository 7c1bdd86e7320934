"""Which clips teach, which choose, which test."""

import hashlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field, model_validator

from physpipe.core.errors import InputError
from physpipe.core.params import Section
from physpipe.io.clips import SPLITS, Split
from physpipe.io.split_file import SPLIT_FILE


class SplitParams(Section):
    """Shares of the clips, by a hash of each clip's name: adding a recording moves no other clip.

    Where the set brings a split file, the file decides; a share of 0 still says that a split may be empty.
    """

    valid: float = Field(ge=0, le=1)
    """Share that chooses when to stop learning."""
    test: float = Field(ge=0, le=1)
    """Share that nothing learns from."""

    @model_validator(mode="after")
    def _shares_add_up(self) -> "SplitParams":
        if self.valid + self.test > 1:
            raise ValueError("valid + test exceeds 1")
        return self


@dataclass(frozen=True)
class Splits:
    """The split of every clip of one data set."""

    shares: SplitParams
    named: Mapping[str, Split] | None
    """Source to split, of all recordings, where the set brings a split file."""

    def of(self, source: str, clip: str) -> Split:
        """The split of a clip of the recording `source`."""
        return drawn(clip, self.shares) if self.named is None else self.named[source]

    def refuse_empty(self, raw: Path, clips: Counter[Split]) -> None:
        """Raises InputError when a split whose share is not 0 has none of the set's `clips`."""
        valid, test = self.shares.valid, self.shares.test
        wanted = {"train": 1 - valid - test > 0, "valid": valid > 0, "test": test > 0}
        drawing = "add recordings, lower `clip_frames`, raise the share"
        mend = drawing if self.named is None else f"name recordings of that split in {SPLIT_FILE}"
        for split in SPLITS:
            if wanted[split] and not clips[split]:
                counts = ", ".join(f"{each} {clips[each]}" for each in SPLITS)
                raise InputError(
                    raw, f"no clip falls into the split `{split}` ({counts})", f"{mend}, or set its share to 0"
                )


def drawn(clip: str, shares: SplitParams) -> Split:
    """The split of a clip by its name alone."""
    place = int.from_bytes(hashlib.sha256(clip.encode()).digest()[:8], "big") / 2**64
    if place < shares.valid:
        return "valid"
    return "test" if place < shares.valid + shares.test else "train"
