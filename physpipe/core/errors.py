"""The one error that means "your input, not our code"."""


class InputError(Exception):
    """Something the user gave cannot be used; says where, why, and how to mend it."""

    def __init__(self, where: object, reason: str, mend: str):
        self.where, self.reason, self.mend = str(where), reason, mend
        super().__init__(self.where, reason, mend)  # the three parts, so that it crosses process pools

    def __str__(self) -> str:
        return f"{self.where}: {self.reason}. To mend: {self.mend}."


class DiskFullError(InputError):
    """Nothing more can be written; no input is at fault, so nothing may be skipped because of it."""

    def __init__(self, where: object, reason: str = "the disk is full", mend: str = "free some space and run again"):
        super().__init__(where, reason, mend)
