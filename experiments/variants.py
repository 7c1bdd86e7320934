"""What an ablation leaves out, one row each."""

from itertools import combinations

RECIPES = {"losses": "sequential", "ingredients": "joint"}
"""Part of the ablation to its recipe: the losses' is the one nearest to the paper's, the ingredients' the default."""
LOSSES = {"disc": "causality", "ent": "entropy", "siam": "equivariance"}
"""The paper's names of the losses, and ours."""
ALL_LOSSES = "+".join(LOSSES)
CONSTANT, FULL = "const", "full recipe"
INGREDIENTS: dict[str, tuple[str, ...]] = {
    "noise bottleneck": ("net.bottleneck.start_px=0", "net.bottleneck.end_px=0"),
    "shape only": ("net.discriminator.shape_only=false",),
    "many shuffles": ("net.negatives=0",),
    "warm start": ("net.warm_start_steps=0",),
    "mirrors": ("net.mirrored=false",),
    "flicker": ("net.flicker=0",),
    "several strides": ("moments.strides=[1]",),
    "two starts": ("starts=1",),
    "strong equivariance": ("net.losses.equivariance=0.001",),
    "motion prior": ("net.losses.motion=0",),
}
"""Ingredient of the recipe to what takes it away, or puts the paper's value in its place."""


def variants() -> dict[str, dict[str, tuple[str, ...]]]:
    """Part of the ablation to its rows to the overrides of each."""
    losses = {}
    for count in range(1, len(LOSSES) + 1):
        for kept in combinations(LOSSES, count):
            dropped = [ours for name, ours in LOSSES.items() if name not in kept]
            losses["+".join(kept)] = tuple(f"net.losses.{each}=0" for each in dropped)
    without = {f"without {name}": keys for name, keys in INGREDIENTS.items()}
    parts = {"losses": losses, "ingredients": {**without, FULL: ()}}
    return {
        part: {
            row: (f"tracker.recipe={RECIPES[part]}", *(f"tracker.recipes.{RECIPES[part]}.{key}" for key in keys))
            for row, keys in rows.items()
        }
        for part, rows in parts.items()
    }
