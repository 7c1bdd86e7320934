"""The kinds of terrain by name."""

from typing import Annotated

import numpy as np
from pydantic import Field

from physpipe.scenes.bowl import Bowl, BowlParams
from physpipe.scenes.height_field import HeightField, HeightsParams
from physpipe.scenes.table import Table, TableParams
from physpipe.scenes.terrain import Terrain

AnyTerrainParams = Annotated[BowlParams | HeightsParams | TableParams, Field(discriminator="kind")]
TERRAINS = {"bowl": Bowl, "heights": HeightField, "table": Table}


def draw_at_random(params: AnyTerrainParams, rng: np.random.Generator) -> Terrain:
    """A terrain of the kind that `params` name."""
    return TERRAINS[params.kind](params, rng)
