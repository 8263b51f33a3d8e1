"""A digest of everything a script computes with: code is an input of its results.

Snakemake reruns a job when a parameter changes. With this digest as a parameter, an
edit of any module that a script reaches reruns it; an edit of a comment, a docstring
or a module it does not reach does not.
"""

from __future__ import annotations

import ast
import hashlib
import re
from functools import lru_cache
from importlib.metadata import packages_distributions, version
from pathlib import Path

import grimp

PACKAGE = "walklab"


def digest(script: str | Path, folder: str | Path) -> str:
    """Hash of a script, the walklab modules it imports transitively and the versions of what those import.

    Parameters
    ----------
    script : path of a Python script
    folder : the ``src/walklab`` folder

    Returns
    -------
    16 hexadecimal digits
    """
    script, folder = Path(script), Path(folder)
    local = _local_helpers(script)
    names = {name for path in (script, *local) for name in _imported(path.read_text())}
    graph = _graph(str(folder))
    modules = _reachable(graph, {name for name in names if name.split(".")[0] == PACKAGE})
    externals = {name.split(".")[0] for name in names} | {
        found.split(".")[0] for module in modules for found in graph.find_modules_directly_imported_by(module)
    }
    parts = [_normalised(path) for path in (script, *local)]
    parts += [f"{module}:{_normalised(_file(module, folder))}" for module in sorted(modules)]
    parts += [f"{name}=={found}" for name, found in sorted(_versions(externals).items())]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def source_digest(folder: str | Path) -> str:
    """Hash of every module below a folder, to the letter.

    Compiled kernels are cached under it: numba notices an edit of the file that a kernel
    stands in, but not of a file that the kernel calls into, and would go on with old code.
    """
    sources = sorted(Path(folder).rglob("*.py"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in sources)).hexdigest()[:16]


@lru_cache(maxsize=1)
def _graph(folder: str) -> grimp.ImportGraph:
    return grimp.build_graph(PACKAGE, include_external_packages=True, cache_dir=None)


def _local_helpers(script: Path) -> list[Path]:
    """Modules beside the script that it imports, directly or through each other."""
    found: set[Path] = set()
    open_paths = [script]
    while open_paths:
        names = _imported(open_paths.pop().read_text())
        new = {path for name in names if (path := script.parent / f"{name}.py").is_file()} - found - {script}
        found |= new
        open_paths += sorted(new)
    return sorted(found)


@lru_cache(maxsize=1024)
def _imported(source: str) -> frozenset[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            # ``from walklab.planning import registry`` may name a module or an attribute.
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(found)


def _reachable(graph: grimp.ImportGraph, names: set[str]) -> set[str]:
    found = {name for name in names if name in graph.modules}
    for name in tuple(found):
        found |= graph.find_upstream_modules(name)
    found = {name for name in found if name.split(".")[0] == PACKAGE}
    # Importing a module runs the __init__ of every package above it, and what that imports.
    above = {".".join(name.split(".")[:depth]) for name in found for depth in range(1, name.count(".") + 1)}
    missing = (above & graph.modules) - found
    return found if not missing else _reachable(graph, found | missing)


def _file(module: str, folder: Path) -> Path:
    base = folder.joinpath(*module.split(".")[1:])
    return base / "__init__.py" if base.is_dir() else base.with_suffix(".py")


def _normalised(path: Path) -> str:
    """Hash of the syntax tree of a file without comments and docstrings."""
    return _without_comments(path.read_text())


@lru_cache(maxsize=1024)
def _without_comments(source: str) -> str:
    tree = ast.parse(source)
    _drop_docstrings(tree)
    # A hash, not the tree: sixty scripts join those of a hundred modules.
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def _drop_docstrings(node: ast.AST) -> None:
    """From a module, class or function and all within; only statements are visited, for expressions hold no docstrings."""
    for name in ("body", "orelse", "finalbody", "handlers", "cases"):
        statements = getattr(node, name, None)
        if not isinstance(statements, list):  # a lambda's body is an expression
            continue
        documented = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and name == "body"
        if documented and statements and _is_docstring(statements[0]):
            del statements[0]
        for statement in statements:
            _drop_docstrings(statement)


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


@lru_cache(maxsize=1)
def _distributions() -> dict[str, list[str]]:
    return dict(packages_distributions())


@lru_cache(maxsize=1024)
def _version(package: str) -> str:
    return version(package)  # reads the whole metadata of the package


def _versions(names: set[str]) -> dict[str, str]:
    """Versions of the distributions behind third-party imports; the standard library has none."""
    known = _distributions()
    return {
        re.sub(r"[-_.]+", "-", package).lower(): _version(package)
        for name in names
        if name != PACKAGE
        for package in known.get(name, [])
    }
