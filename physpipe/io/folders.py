"""What a folder of film holds: its recordings, at any depth, and the names that they go by."""

import re
from pathlib import Path

from physpipe.core.errors import InputError

IMAGE_SUFFIXES = {".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"}
# Licences, notes, tables, positions; any other file is taken for a video, so that a broken one is named, not skipped
COMPANION_SUFFIXES = {"", ".csv", ".html", ".json", ".log", ".mat", ".md", ".npy", ".npz", ".pdf", ".tsv", ".txt"} | {
    ".xml",
    ".yaml",
    ".yml",
}


def recordings(folder: Path) -> list[Path]:
    """Sorted video files and image folders of `folder` and of the folders in it.

    A folder of images is a recording. Raises InputError when there is no recording, and for images beside recordings.
    """
    if not folder.is_dir():
        raise InputError(folder, "no such folder", "give a folder of videos")
    found = _below(folder)
    _refuse_lone_images(folder)
    if not found:
        raise InputError(folder, "holds no recording", "put video files or folders of images into it")
    return sorted(found)


def images(folder: Path) -> list[Path]:
    """A recording's images by name, numbers in names counting as numbers (2 before 10)."""
    found = [path for path in folder.iterdir() if path.suffix.lower() in IMAGE_SUFFIXES and path.name[0] != "."]
    return sorted(found, key=lambda path: [(int(n or 0), text) for n, text in re.findall(r"(\d*)(\D*)", path.name)])


def source(recording: Path, folder: Path) -> str:
    """The recording's name in every table: its path inside the set's `folder`, with `/` on every system."""
    return recording.relative_to(folder).as_posix()


def stem(recording: Path, folder: Path) -> str:
    """`source` without a video file's suffix."""
    return source(recording if recording.is_dir() else recording.with_suffix(""), folder)


def _below(folder: Path) -> list[Path]:
    found = []
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue
        if path.is_dir():
            found += [] if _leads_back(path) else _of_subfolder(path)
        elif path.suffix.lower() not in COMPANION_SUFFIXES | IMAGE_SUFFIXES:
            found.append(path)
    return found


def _of_subfolder(folder: Path) -> list[Path]:
    """The recordings in it, or itself where it holds images and nothing else."""
    found = _below(folder)
    if not images(folder):
        return found
    if found:
        _refuse_lone_images(folder)
    return [folder]


def _refuse_lone_images(folder: Path) -> None:
    for path in images(folder):
        raise InputError(path, "a lone image", "put the images of one recording into a folder of their own")


def _leads_back(folder: Path) -> bool:
    """Whether it is a link to a folder that it lies in, which would never end."""
    return folder.is_symlink() and folder.parent.resolve().is_relative_to(folder.resolve())
