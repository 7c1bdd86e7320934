"""Params of the smallest flow training, shared by tests."""

from physpipe.flow_learning.flow import FlowParams


def params(steps: int) -> FlowParams:
    """One ball of 4 px that goes up to 6 px in pictures of 32 px, and a network to match."""
    look = {
        "surface_grey": [90, 120],
        "tint": 10,
        "mottle": 0.1,
        "mottle_px": 8,
        "dye": [1, 1, 1],
        "texture": None,
        "contour_m": 0.08,
        "contour_contrast": 0.1,
        "rim": 0.05,
        "rim_brightness": 1.1,
        "table_brightness": 0.8,
        "light_tilt_deg": [10, 40],
        "ambient": 0.45,
        "gloss": 80,
        "shadow": 0.3,
        "shadow_softness": 0.6,
    }
    pairs = {
        "size": 32,
        "balls": [1, 1],
        "radius_px": [4, 4],
        "rgb": [180, 250],
        "step_px": 6,
        "camera_px": 1,
        "exposure": [0, 0.1],
        "shutter_moments": 2,
        "drift": 0.05,
        "noise": [1, 2],
        "pixels_per_metre": 112,
        "hill_m": [0, 0.05],
        "hill_px": 16,
        "look": look,
    }
    fit = {
        "steps": steps,
        "batch_size": 4,
        "learning_rate": 0.004,
        "final_rate": 0.1,
        "warmup_steps": 3,
        "weight_decay": 0,
        "clip_norm": 1,
        "valid_every": 3 if steps < 20 else 20,
        "patience": 100,
        "precision": "float32",
    }
    return FlowParams.model_validate(
        {
            "network": {
                "channels": [12, 16],
                "radii": [2, 2],
                "decoder": 16,
                "contrast_px": 9,
                "inside_weight": 1,
                "level_weight": 0.4,
            },
            "pairs": pairs,
            "fit": fit,
            "valid_pairs": 8,
            "verdict": {"pairs": 6, "shown": 2},
        }
    )
