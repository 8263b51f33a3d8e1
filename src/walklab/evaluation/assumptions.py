"""Every assumption that the code and the configuration state, for the report."""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterator, Sequence
from pathlib import Path

import pandas as pd

from walklab.errors import InputError

_MARK = re.compile(r"#\s*ASSUME:?\s+(?P<text>\S.*)")
_COMMENT_ONLY = re.compile(r"^\s*#\s?(?P<text>.*)$")
FOLDERS = ("src/walklab", "workflow", "config")
SUFFIXES = (".py", ".smk", ".yaml", ".yml")


def list_assumptions(root: str | Path, folders: Sequence[str] = FOLDERS) -> pd.DataFrame:
    """All assumption comments below the folders of a checkout, with the comment lines that continue them.

    Returns
    -------
    DataFrame[file, line, text] in the order of the files; ``file`` relative to the root

    Raises
    ------
    InputError
        If the root has none of the folders.
    """
    base = Path(root)
    present = [base / folder for folder in folders if (base / folder).is_dir()]
    if not present:
        raise InputError(f"{base}: has none of the folders {', '.join(folders)}; give the root of the checkout")
    files = sorted(path for folder in present for path in folder.rglob("*") if path.suffix in SUFFIXES)
    rows = [
        {"file": path.relative_to(base).as_posix(), "line": line, "text": text}
        for path in files
        for line, text in _assumptions(path.read_text(), path.suffix)
    ]
    return pd.DataFrame(rows, columns=["file", "line", "text"])


def _assumptions(source: str, suffix: str) -> Iterator[tuple[int, str]]:
    lines = source.splitlines()
    for number, comment in _comments(source, suffix):
        mark = _MARK.match(comment)
        if mark is None:
            continue
        parts = [mark["text"].strip()]
        for following in lines[number:]:
            more = _COMMENT_ONLY.match(following)
            if more is None or _MARK.match(following.strip()) or not more["text"].strip():
                break
            parts.append(more["text"].strip())
        yield number, " ".join(parts)


def _comments(source: str, suffix: str) -> Iterator[tuple[int, str]]:
    """Line numbers and texts of comments; in Python code by its tokens, so that no string passes for a comment."""
    if suffix == ".py":
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.string
        return
    for number, line in enumerate(source.splitlines(), start=1):
        at = line.find("#")
        if at >= 0:
            yield number, line[at:]
