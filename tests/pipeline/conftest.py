"""A whole project on a tiny world, as cloned, and reproduced once; each test works on a project of its own."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
PARTS = [
    "physpipe",
    "stages",
    "experiments",
    "metrics/templates",
    "metrics/ablation.json",
    "dvc.yaml",
    "params.yaml",
    ".dvc/config",
    ".dvcignore",
    ".gitignore",
]
TINY = {
    "run.datasets": ["bowls"],
    "run.simulated": ["bowls"],
    "compute.threads": 1,
    "datasets.bowls.simulate.sizes.default.clips": 16,
    "datasets.bowls.simulate.sizes.default.moving_frames": 102,
    "datasets.bowls.ingest.clip_frames": 26,
    "datasets.bowls.ingest.min_frames": 26,
    "datasets.bowls.predict.horizon": 6,
    "tracker.recipes.joint.starts": 1,
    "tracker.recipes.joint.start.steps": 6,
    "tracker.recipes.joint.rest.steps": 4,
    "tracker.recipes.joint.net.warm_start_steps": 3,
    "tracker.recipes.sequential.starts": 1,
    "tracker.recipes.sequential.start.steps": 6,
    "tracker.recipes.sequential.rest.steps": 4,
    "tracker.recipes.sequential.net.warm_start_steps": 3,
    "tracker.signals.batches": 1,
    "flow.corrflow.fit.steps": 2,
    "flow.corrflow.valid_pairs": 2,
    "flow.corrflow.verdict.pairs": 2,
    "predictors.dispnet.fit.steps": 3,
    "predictors.dispnet.fit.batch_size": 4,
    "finetune.fit.steps": 2,
    "finetune.fit.batch_size": 4,
    "finetune.held_out": 4,
    "report.clips_shown": 1,
    "report.film.clips": 1,
}


def environment() -> dict[str, str]:
    """This process's, less what would steer DVC or Git, with the commands of this virtual environment first."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("DVC_", "GIT_"))}
    plain.pop("PYTHONDONTWRITEBYTECODE", None)  # compiled files must not mark a stage as changed
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return plain | {"PATH": path, "DVC_NO_ANALYTICS": "1", "PHYSPIPE_WORKERS": "1", "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Project:
    """A checkout to run commands in."""

    root: Path

    def copied(self, folder: Path) -> "Project":
        """A copy of this checkout in `folder`, to change at will."""
        shutil.copytree(self.root, folder / "checkout", symlinks=True)
        return Project(folder / "checkout")

    def run(self, *words: str, succeeds: bool = True) -> str:
        """What the command prints; fails the test when its exit status is not the one expected."""
        done = subprocess.run(
            words, cwd=self.root, env=environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        assert (done.returncode == 0) == succeeds, done.stdout[-3000:]
        return done.stdout

    def repro(self, *words: str) -> set[str]:
        """Reproduces; the names of the stages that ran."""
        printed = self.run("dvc", "repro", *words)
        return {line.split("'")[1] for line in printed.splitlines() if line.startswith("Running stage '")}

    def start(self, *words: str) -> subprocess.Popen:
        """The command as a process group of its own, to be killed."""
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen(words, cwd=self.root, env=environment(), start_new_session=True, **quiet)

    def write(self, values: dict[str, object]) -> None:
        """Writes values into params.yaml by dotted key."""
        yaml, path = YAML(), self.root / "params.yaml"
        tree = yaml.load(path)
        for key, value in values.items():
            *parents, last = key.split(".")
            node = tree
            for parent in parents:
                node = node[parent]
            assert last in node, key
            node[last] = value
        yaml.dump(tree, path)

    def commit(self, message: str) -> None:
        """Commits everything that Git does not ignore."""
        self.run("git", "add", "--all")
        self.run("git", "commit", "-qm", message)


def cloned(root: Path) -> Project:
    """The tiny project in the new folder `root`, nothing of it run yet, all that Git keeps committed."""
    for part in PARTS:
        source, target = ROOT / part, root / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    project = Project(root)
    project.write(TINY)
    project.run("git", "init", "-q")
    project.run("git", "config", "user.name", "test")
    project.run("git", "config", "user.email", "test@example.invalid")
    project.run("dvc", "config", "core.analytics", "false")
    project.commit("tiny project")
    return project


@pytest.fixture(scope="session")
def reproduced(tmp_path_factory) -> Project:
    """The tiny project after its first `dvc repro`; not to be changed."""
    project = cloned(tmp_path_factory.mktemp("project") / "checkout")
    project.repro()
    project.commit("tiny project, reproduced")
    return project


@pytest.fixture
def project(reproduced, tmp_path) -> Project:
    """A copy of the reproduced project to change at will."""
    return reproduced.copied(tmp_path)


@pytest.fixture
def clone(tmp_path) -> Project:
    """The tiny project of which nothing has run, to change at will."""
    return cloned(tmp_path / "clone")
