"""One colour a model, everywhere; first the palette of Okabe and Ito, which colour-blind people can tell apart."""

PALETTE = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b4c9a")
REFERENCE = "#000000"
"""Colour of what any method must beat: standing still, the frame's centre."""
FALLBACK = "#8c8c8c"
TRUTH, FORECAST = "#ffffff", "#f0e442"
OBJECTS = ("#e69f00", "#56b4e9", "#cc79a7", "#009e73", "#d55e00", "#0072b2")

PREDICTORS = {
    "dispnet": PALETTE[0],
    "dispnet_long": "#882255",
    "posnet": PALETTE[1],
    "probnet": PALETTE[2],
    "ifs": PALETTE[3],
    "vin": PALETTE[4],
    "terrain": PALETTE[5],
    "interpnet": PALETTE[6],
    "linear": "#5a5a5a",
    "quadratic": "#a0a0a0",
    "persistence": REFERENCE,
}
TRACKERS = {
    "unsupervised": PALETTE[0],
    "unsupervised_unrefined": PALETTE[5],
    "lucas_kanade": PALETTE[1],
    "lab": PALETTE[2],
    "trackpy": PALETTE[3],
    "median_blob": PALETTE[4],
    "knn_blob": PALETTE[6],
    "mog2_blob": "#1f2bd6",
    "dis_simple": "#7a9a01",
    "dis_blob": "#8b2323",
    "farneback_simple": "#e6005c",
    "farneback_blob": "#b04fd6",
    "flow_simple": "#5c5a1e",
    "flow_blob": "#c9b98a",
    "centre": REFERENCE,
    "persistence": "#5a5a5a",
}


def of_predictor(name: str) -> str:
    """Hex colour of a predictor's lines."""
    return PREDICTORS.get(name, FALLBACK)


def of_tracker(name: str) -> str:
    """Hex colour of a tracker's lines."""
    return TRACKERS.get(name, FALLBACK)


def of_object(number: int) -> str:
    """Hex colour of an object's dot and trail."""
    return OBJECTS[number % len(OBJECTS)]


def rgb(colour: str) -> tuple[int, int, int]:
    """Hex colour to red, green, blue in 0 .. 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def for_page(colour: str) -> str:
    """The colour as the page's style sheet knows it: references are drawn like text, light on a dark page."""
    return "var(--ink)" if colour == REFERENCE else colour
