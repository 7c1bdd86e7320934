"""Numbers in sentences."""


def counted(number: int, noun: str, nouns: str = "") -> str:
    """`1 film`, `2 films`; `nouns` is a plural that takes more than an s."""
    return f"{number} {noun if number == 1 else nouns or f'{noun}s'}"
