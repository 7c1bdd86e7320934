"""What of a recording will hurt, in plain words with figures and a mend."""

from collections.abc import Sequence

from physpipe.core.geometry import Geometry
from physpipe.ingest.rates import WRONG_CLAIM
from physpipe.io.split_file import SPLIT_FILE
from physpipe.probing.advice import FEWEST_CLIPS, FORECAST_FRAMES, Advice, horizon
from physpipe.probing.findings import Finding

JUMP_PX, TRAVEL_PX = 0.5, 2.0
"""Clip pixels that the camera may move between two frames, and in all."""
FLICKER, DRIFT = 0.03, 0.25
"""Relative changes of brightness, likewise."""
BLUR_PX = 1.5
"""Clip pixels of blur: more hides where an object ends."""
FAST_PX = 10.0
"""Clip pixels a frame, the gate of the trackers."""
FAST_DIAMETERS = 1.5
"""Diameters a frame: faster things are streaks."""
SMALL_PX, LARGE_PX = 4.0, 40.0
"""Clip pixels, an object's diameter."""
REPEATED = 0.1
"""Share of the frames that may repeat."""
DISTURBED, MOVING = 0.05, 0.5
"""Shares of the looks: at most with something larger in them, at least with motion."""
FEWEST_FRAMES = 40


def hurts(finding: Finding, geometry: Geometry) -> list[str]:
    """Warnings; `geometry` says where the clips lie in the frame."""
    per_px = float(geometry.scale[0])
    return [*_film(finding), *_camera(finding, per_px), *_objects(finding, geometry, per_px)]


def _film(finding: Finding) -> list[str]:
    film = finding.film
    found = list(film.clock.warnings)
    if film.rotation:
        found.append(f"a flag turns it by {film.rotation} degrees: sizes and boxes here are of the upright picture")
    if film.clock.frames < FEWEST_FRAMES:
        found.append(f"only {film.clock.frames} frames: film longer, or more of it")
    if finding.repeated > REPEATED:
        mend = "give the true rate by `physpipe add --fps`"
        found.append(f"{finding.repeated:.0%} of the frames repeat the one before: {mend}")
    return found


def _camera(finding: Finding, per_px: float) -> list[str]:
    found = []
    if finding.jump_px * per_px > JUMP_PX or finding.travel_px * per_px > TRAVEL_PX:
        moved = f"{finding.jump_px:.1f} px between frames, {finding.travel_px:.0f} px in all"
        found.append(f"the camera moves ({moved}): use a tripod, or lean it on something")
    if finding.flicker > FLICKER:
        found.append(f"the light flickers by {finding.flicker:.0%} from frame to frame: use daylight or lamps on DC")
    if finding.drift > DRIFT:
        found.append(f"the brightness changes by {finding.drift:.0%}: lock the camera's exposure")
    if finding.blur_px * per_px > BLUR_PX:
        blur = f"{finding.blur_px:.1f} px, {finding.blur_px * per_px:.1f} px of a clip"
        found.append(f"blurred by {blur}: focus, and lock the focus")
    return found


def _objects(finding: Finding, geometry: Geometry, per_px: float) -> list[str]:
    if finding.box is None:
        return ["nothing moves: the recording gives no clip"]
    found = []
    diameter, speed = finding.diameter_px, finding.speed_px
    if finding.movers is not None and finding.movers.number is None:
        found.append("frames do not agree on how many objects there are: count them, and give `physpipe add --objects`")
    if finding.disturbed > DISTURBED:
        found.append(f"something else moves in {finding.disturbed:.0%} of the looks (a hand, a shadow?): keep it out")
    if finding.moving < MOVING:
        found.append(f"something moves in {finding.moving:.0%} of the looks only; the still parts are cut off")
    if speed * per_px > FAST_PX or speed > FAST_DIAMETERS * diameter:
        pace = f"{speed:.0f} px a frame, {speed / diameter:.1f} diameters, {speed * per_px:.0f} px of a clip"
        found.append(f"objects move fast ({pace}) and will smear: film more frames a second, with a short exposure")
    if not SMALL_PX < diameter * per_px < LARGE_PX:
        how, mend = ("small", "closer") if diameter * per_px <= SMALL_PX else ("large", "from farther away")
        found.append(f"objects are {how} ({diameter * per_px:.0f} px of a clip): film {mend}, or set `crop` by hand")
    if not _within(finding.box, geometry):
        found.append("objects leave the clips' square, which is as high as the frame: move the camera back, or turn it")
    return found


def _within(box: tuple[int, int, int, int], geometry: Geometry) -> bool:
    left, top, right, bottom = box
    across = geometry.left <= left and right <= geometry.left + geometry.crop_width
    return across and geometry.top <= top and bottom <= geometry.top + geometry.crop_height


def hurts_of_set(found: Sequence[Finding], advice: Advice) -> list[str]:
    """What no single recording shows."""
    said = []
    sizes = sorted({(each.film.width, each.film.height) for each in found})
    if len(sizes) > 1:
        named = ", ".join(f"{width} x {height}" for width, height in sizes)
        said.append(f"recordings of several sizes ({named} px): one crop cannot fit them; make a set of each")
    rates = [each.film.clock.measured_fps for each in found]
    if max(rates) > min(rates) * (1 + WRONG_CLAIM) and advice.source_fps is None:
        said.append(f"rates from {min(rates):.4g} to {max(rates):.4g} frames/s: `fps` brings them to one")
    if len({each.movers.number for each in found if each.movers}) > 1:
        mend = "give `physpipe add --objects`, or make a set of each"
        said.append(f"recordings do not agree on how many objects there are: {mend}")
    if advice.cut.empty:
        mend = f"add film, or say by a {SPLIT_FILE} which recording is for what"
        said.append(f"no clip for {' and '.join(advice.cut.empty)}, as names are drawn: {mend}")
    if horizon(advice.cut.frames) < FORECAST_FRAMES:
        short = f"clips of {advice.cut.frames} frames only, forecast to frame {horizon(advice.cut.frames)}"
        said.append(f"{short}: film longer, or cut fewer and longer ones by `physpipe add --clip-frames`")
    if advice.cut.clips < FEWEST_CLIPS:
        said.append(f"only about {advice.cut.clips} clips of {advice.cut.frames} frames: too little to learn from")
    return said
