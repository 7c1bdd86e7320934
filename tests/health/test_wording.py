"""One of a thing is no plural."""

from physpipe.health.wording import counted


def test_one_is_no_plural():
    assert [counted(number, "film") for number in (0, 1, 2)] == ["0 films", "1 film", "2 films"]
    assert counted(3, "kind of stages", "kinds of stages") == "3 kinds of stages"
