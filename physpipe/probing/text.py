"""What a probe found, as lines to print."""

from collections.abc import Iterator

import numpy as np

from physpipe.probing.crop import geometry
from physpipe.probing.findings import Finding
from physpipe.probing.folder import Probed
from physpipe.probing.hurts import hurts, hurts_of_set


def described(probed: Probed, size: int) -> Iterator[str]:
    """A paragraph a recording, then what concerns the set; `size` is the side of its clips' frames in pixels."""
    for each in probed.found:
        yield f"{each.source}"
        yield from (f"  {line}" for line in _facts(each))
        yield from (f"  ! {line}" for line in hurts(each, geometry(each, probed.advice.crop, size)))
        yield ""
    for error in probed.unreadable:
        yield f"! {error}"
    yield from (f"! {line}" for line in hurts_of_set(probed.found, probed.advice))


def _facts(finding: Finding) -> Iterator[str]:
    film, clock = finding.film, finding.film.clock
    rate = f", {clock.measured_fps:.4g} frames/s (header: {clock.claimed_fps:.4g}), {clock.length_s:.3g} s"
    yield f"{film.width} x {film.height} px, {clock.frames} frames{rate if np.isfinite(clock.measured_fps) else ''}"
    if finding.movers is None or finding.box is None:
        return
    left, top, right, bottom = finding.box
    first, last = finding.span
    clocked = np.isfinite(clock.length_s)
    when = f"from {first * clock.length_s:.1f} to {last * clock.length_s:.1f} s, " if clocked else ""
    yield f"motion in {finding.moving:.0%} of the looks, {when}in x {left} to {right}, y {top} to {bottom} px"
    number = {None: "objects", 1: "1 object"}.get(finding.movers.number, f"{finding.movers.number} objects")
    speed = f", up to {finding.speed_px:.0f} px a frame" if np.isfinite(finding.speed_px) else ""
    yield f"likely {number} of about {finding.diameter_px:.0f} px{speed}"
