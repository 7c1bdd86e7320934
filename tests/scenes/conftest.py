"""A small world with two balls and every nuisance on, in a frame that is not square."""

import pytest

from physpipe.scenes.world_params import WorldParams


@pytest.fixture
def world() -> WorldParams:
    return WorldParams.model_validate(
        {
            "clips": 2,
            "still_frames": [3, 6],
            "moving_frames": 40,
            "terrain": {"kind": "bowl", "fixed": False, "rim_radius_m": [0.2, 0.3], "depth_m": [0.15, 0.2], "cut": 0.7},
            "balls": {
                "count": 2,
                "colours": "listed",
                "radius_m": [0.03, 0.03],
                "start_level": [0.4, 0.7],
                "start_speed_m_s": [0.2, 0.6],
                "heading_spread_deg": 180,
            },
            "palette": [[235, 70, 30], [40, 90, 230], [60, 180, 60]],
            "physics": {
                "gravity_m_s2": 9.81,
                "steps_per_frame": 8,
                "contact_s": 0.008,
                "friction": 0.5,
                "rolling_resistance_m": 0.0002,
                "restitution": 0.9,
            },
            "look": {
                "surface_grey": [120, 165],
                "tint": 15,
                "dye": [1, 1, 1],
                "mottle": 0.03,
                "mottle_px": 16,
                "texture": None,
                "contour_m": 0.03,
                "contour_contrast": 0.15,
                "rim": 0.05,
                "rim_brightness": 1.15,
                "table_brightness": 0.55,
                "light_tilt_deg": [20, 40],
                "ambient": 0.45,
                "gloss": 80,
                "shadow": 0.5,
                "shadow_softness": 0.6,
            },
            "camera": {
                "width": 128,
                "height": 112,
                "fps": 240,
                "pixels_per_metre": 160,
                "off_centre_px": 2,
                "wobble_px": 2,
                "wobble_hz": 3,
                "drift": 0.15,
                "drift_hz": 1.5,
                "exposure": 0.5,
                "shutter_moments": 5,
                "noise": 4,
                "crf": 18,
            },
        }
    )
