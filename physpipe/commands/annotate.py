"""`physpipe annotate`: truth checked and corrected in the browser."""

from argparse import Namespace

from physpipe.annotator import serving
from physpipe.commands.making import made, running
from physpipe.commands.places import ANNOTATIONS, CLIPS, known_set
from physpipe.core.params import read_value
from physpipe.io.clips import TABLE


def run(words: Namespace) -> None:
    """Template boxes and corrections into data/annotations; ends with Ctrl+C."""
    name = known_set(words.name)
    if "simulate" not in read_value(f"datasets.{name}"):  # else the refusal to annotate comes first
        made(CLIPS / name / TABLE, name, "ingest")
    serving.annotate(name, CLIPS / name, ANNOTATIONS / name, words.port, words.browser)
    print(f"\nNext: {running(name)}, which works out the truth of {name} anew.")
