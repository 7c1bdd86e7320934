"""`physpipe annotate`: truth checked and corrected in the browser."""

from argparse import Namespace
from pathlib import Path

from physpipe.annotator import serving


def run(words: Namespace) -> None:
    """Template boxes and corrections into data/annotations; ends with Ctrl+C."""
    place = Path("data/annotations") / words.name
    serving.annotate(words.name, Path("data/clips") / words.name, place, words.port, words.browser)
