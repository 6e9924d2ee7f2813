"""A scenario's text with values changed, comments and order kept."""

import re


def edited(text, changes):
    """`changes`: {'table.key' or 'key': text of the value}. Keys of repeated tables change in all of them. KeyError if a key is not there."""
    lines, table, found = [], "", set()
    for line in text.splitlines():
        header = re.match(r"\[+([\w.]+)\]+", line)
        table = header.group(1) if header else table
        key = re.match(r"(\w+)\s*=", line)
        path = f"{table}.{key.group(1)}".lstrip(".") if key else ""
        if path in changes:
            line = f"{key.group(1)} = {changes[path]}"
            found.add(path)
        lines.append(line)
    if missing := sorted(set(changes) - found):
        raise KeyError(f"no key {', '.join(missing)}")
    return "\n".join(lines) + "\n"


def literal(value):
    """A TOML value of a Python one."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else repr(value)
