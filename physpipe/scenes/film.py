"""The camera: where the scene falls in the frame, hand wobble, drifting light, sensor noise, compression."""

import io
from collections.abc import Iterable, Iterator
from typing import cast

import av
import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physpipe.core.params import Section

Image = NDArray[np.float32]
Frame = NDArray[np.uint8]
WAVES = 3  # sinusoids that make up one smooth drift
ROLL = 64  # the noise bank exceeds the frame by this many pixels each way: ROLL^2 different noises


class CameraParams(Section):
    """A camera straight above the scene, far away, that somebody leans on."""

    width: int = Field(ge=16, multiple_of=2)
    """Frame width in pixels; even, for 4:2:0 colour."""
    height: int = Field(ge=16, multiple_of=2)
    """Frame height in pixels; even."""
    fps: int = Field(ge=1)
    """Frames per second."""
    pixels_per_metre: float = Field(gt=0)
    """Scale of the picture, the same along x and y."""
    off_centre_px: float = Field(ge=0)
    """Largest distance along x and y of the scene's middle from the frame's, in pixels."""
    wobble_px: float = Field(ge=0)
    """Largest shift of the picture by camera wobble, in pixels."""
    wobble_hz: float = Field(gt=0)
    """Highest frequency of the wobble."""
    drift: float = Field(ge=0, lt=1)
    """Largest relative change of brightness by drifting light."""
    drift_hz: float = Field(gt=0)
    """Highest frequency of the drift."""
    exposure: float = Field(ge=0, le=1)
    """Part of the time between two frames during which the shutter is open: the motion blur."""
    shutter_moments: int = Field(ge=1)
    """Moments of one exposure that are drawn and averaged into the motion blur."""
    noise: float = Field(ge=0)
    """Standard deviation of the sensor's noise, in grey levels of 0 to 255."""
    crf: int = Field(ge=0, le=51)
    """H.264's constant rate factor: 0 is lossless, 18 hardly visible, above 30 coarse."""


class Camera:
    """One clip's camera: the frame of F moments, with its own wobble, drift and noise."""

    def __init__(self, params: CameraParams, frames: int, rng: np.random.Generator):
        self.params = params
        middle = (np.array([params.width, params.height]) - 1) / 2
        self.centre = middle + rng.uniform(-params.off_centre_px, params.off_centre_px, 2)
        shakes = [smooth_drift(frames, params.fps, params.wobble_hz, rng) for _ in range(2)]
        self.wobble = params.wobble_px / np.sqrt(2) * np.stack(shakes, axis=1)  # (F, 2) pixels
        self.gain = 1 + params.drift * smooth_drift(frames, params.fps, params.drift_hz, rng)  # (F,)
        self._rng = rng

    def project(self, xyz_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """(F, K, 3) metres to (F, K, 2) pixels of the wobbling frame; y runs down."""
        return self.centre + self.params.pixels_per_metre * xyz_m[..., :2] + self.wobble[:, None]

    def expose(self, pictures: Iterable[Image]) -> Iterator[Frame]:
        """Noisy frames of the F noiseless (H, W, 3) pictures, both 0 to 255, under the drifting light."""
        height, width = self.params.height, self.params.width
        bank = self._rng.standard_normal((height + ROLL, width + ROLL, 3), np.float32) * np.float32(self.params.noise)
        corners = self._rng.integers(0, ROLL, (len(self.gain), 2))
        for picture, gain, (y, x) in zip(pictures, self.gain.tolist(), corners.tolist(), strict=True):
            grain = bank[y : y + height, x : x + width]
            yield cast(Frame, cv2.addWeighted(picture, gain, grain, 1, 0, dtype=cv2.CV_8U))


def smooth_drift(frames: int, fps: float, highest_hz: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """(F,) a random curve within [-1, 1] that holds no frequency above `highest_hz`."""
    weight = rng.dirichlet(np.ones(WAVES))
    hertz = rng.uniform(0.2, 1, WAVES) * highest_hz
    phase = rng.uniform(0, 2 * np.pi, WAVES)
    return np.sin(2 * np.pi * np.outer(np.arange(frames) / fps, hertz) + phase) @ weight


def encode(frames: Iterable[Frame], params: CameraParams) -> bytes:
    """An H.264 file (MP4) of (H, W, 3) RGB frames; one thread, since more would change its bytes."""
    buffer = io.BytesIO()
    with av.open(buffer, "w", format="mp4") as container:
        quality = {"preset": "ultrafast", "crf": str(params.crf)}
        stream = container.add_stream("libx264", rate=params.fps, options=quality)
        stream.width, stream.height, stream.pix_fmt = params.width, params.height, "yuv420p"
        stream.codec_context.thread_count = 1
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
        container.mux(stream.encode())
    return buffer.getvalue()
