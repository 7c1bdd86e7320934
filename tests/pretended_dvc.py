"""A Git and a DVC that only pretend, for tests of what is asked of them."""

import json

from experiments.records import CommandError

BASE, OLD = "a" * 40, "b" * 40
"""The commit of today's code, and one of other code."""
TRACKERS = {"bowls": {"unsupervised": {"mean_px": 0.5}}}


class Pretended:
    """Answers as git and dvc would; a task runs for one poll, then succeeds unless its label is in `broken`.

    After each answer the queue's status fails `garbled` times.
    """

    def __init__(self, finished=(), broken=(), changed="", tasks=(), workers=0, starts=True, garbled=0):
        self.refs = [(name, base) for name, base in finished]
        self.broken, self.changed, self.starts = broken, changed, starts
        self.tasks, self.workers = list(tasks), workers
        self.garbled, self.failures = garbled, 0
        self.said: list[tuple[str, ...]] = []

    def __call__(self, *words: str) -> str:
        self.said.append(words)
        answers = {
            ("git", "status"): lambda: self.changed,
            ("git", "for-each-ref"): self._refs,
            ("git", "diff"): lambda: "physpipe/core/ball.py" if words[3] == OLD else "",
            ("git", "log"): lambda: "" if "data" in words else f"{BASE[:7]}\n",
            ("git", "show"): lambda: self._show(words[-1]),
            ("dvc", "exp"): lambda: self._queue(words),
            ("dvc", "queue"): lambda: self._manage(words[2:]),
        }
        return answers[words[:2]]()

    def _refs(self):
        lines = [f"{'1' * 40} refs/exps/{base[:2]}/{base[2:]}/{name}" for name, base in self.refs]
        return "\n".join([*lines, f"{'2' * 40} refs/exps/celery/stash"])

    def _show(self, what):
        if what.endswith(":params.yaml"):
            return "compute: {seed: 0}\n"
        return json.dumps(TRACKERS) if ":" in what else "2026-01-02T03:04:05+00:00\n"

    def _queue(self, words):
        self.tasks.append([f"{len(self.tasks):07x}", words[words.index("--name") + 1], "Queued"])
        return ""

    def _manage(self, words):
        if words[0] == "start":
            self.workers = int(self.starts)
        if words[0] == "remove":
            self.tasks = [task for task in self.tasks if task[0] not in words]
        if words[0] == "logs":
            return "step 1\nerror: params.yaml: bad. To mend: mend it.\nERROR: failed to reproduce\n\n"
        if words[0] == "status":
            if self.failures < self.garbled:
                self.failures += 1
                raise CommandError("`dvc queue status` failed: ERROR: unexpected error - Expecting value")
            self.failures = 0
            rows = "\n".join(f"{task}  {name}  04:03 AM   {state}" for task, name, state in self.tasks)
            self._advance()
            return f"Task  Name  Created  Status\n{rows}\n\nWorker status: {self.workers} active, 0 idle\n"
        return ""

    def _advance(self):
        for task in self.tasks if self.workers else []:
            if task[2] == "Running":
                task[2] = "Failed" if task[1].rsplit("-", 1)[0] in self.broken else "Success"
                self.refs += [(task[1], BASE)] if task[2] == "Success" else []
            elif task[2] == "Queued":
                task[2] = "Running"

    @property
    def queued(self) -> list[tuple[str, ...]]:
        return [words for words in self.said if words[:2] == ("dvc", "exp")]
