"""params.yaml as people wrote it: a section or a list item more, every other byte kept."""

import io
import textwrap
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError

from physpipe.core.errors import InputError


def with_section(text: str, parent: str, template: str, name: str, changes: dict[str, Any]) -> str:
    """`text` with `parent.name` after `parent.template`: its copy, comments and all, but for `changes`.

    `changes` maps `a.b` to a value; keys that the template lacks are refused. A section `name` that exists stays.
    Raises InputError when parent or template are absent.
    """
    sections = _find(text, parent)
    if name in sections:
        return text
    if template not in sections:
        raise InputError("params.yaml", f"no section `{parent}.{template}` to copy", "restore it from Git")
    lines = (text.rstrip() + "\n").splitlines(keepends=True)
    start, indent = sections.lc.key(template)
    end = _end_of_block(lines, start, indent)
    block = textwrap.dedent("".join(lines[start:end])).replace(template, name, 1)
    added = textwrap.indent(_changed(block, name, changes), " " * indent)
    return "".join([*lines[:end], added, *lines[end:]])


def with_item(text: str, where: str, item: str) -> str:
    """`text` with `item` at the end of the list at `where`, unless it is in it."""
    items = _find(text, where)
    if item in items:
        return text
    lines = text.splitlines(keepends=True)
    if items.fa.flow_style() or not items:
        start = sum(map(len, lines[: items.lc.line])) + items.lc.col
        end = text.index("]", start)
        return f"{text[:end]}{', ' if items else ''}{item}{text[end:]}"
    line, column = items.lc.item(len(items) - 1)
    return "".join([*lines[: line + 1], f"{lines[line][:column]}{item}\n", *lines[line + 1 :]])


def _find(text: str, where: str) -> Any:
    node = _yaml().load(text)
    for key in where.split("."):
        if not isinstance(node, CommentedMap) or not isinstance(node.get(key), CommentedMap | CommentedSeq):
            raise InputError("params.yaml", f"no section `{where}`", "restore it from Git")
        node = node[key]
    return node


def _end_of_block(lines: list[str], start: int, indent: int) -> int:
    """Line after the last one that belongs to the key at `start`; comments behind it belong to what follows."""
    end = start + 1
    for number, line in enumerate(lines[start + 1 :], start + 1):
        content = line.strip()
        if content and not content.startswith("#"):
            if len(line) - len(line.lstrip()) <= indent:
                break
            end = number + 1
    return end


def _changed(block: str, name: str, changes: dict[str, Any]) -> str:
    try:
        section = _yaml().load(block)
    except YAMLError as error:
        raise InputError("params.yaml", f"its section cannot be copied ({error})", "write it without anchors") from None
    for path, value in changes.items():
        *parents, key = path.split(".")
        node = section[name]
        for parent in parents:
            node = node[parent]
        if key not in node:
            raise InputError("params.yaml", f"the section to copy has no key `{path}`", "add the key to it")
        node[key] = value
    written = io.StringIO()
    _yaml().dump(section, written)
    return written.getvalue()


def _yaml() -> YAML:
    yaml = YAML()
    yaml.width = 80
    return yaml
