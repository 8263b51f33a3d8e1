"""What the sources must not contain, and what the lock files must."""

import ast
import io
import re
import subprocess
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Benchmarks are left out: one compares with unpickling a file that it wrote itself.
SOURCES = sorted([*(ROOT / "src").rglob("*.py"), *(ROOT / "workflow").rglob("*.py")])
RULES = [ROOT / "Snakefile", *sorted((ROOT / "workflow").rglob("*.smk"))]
LOCKS = sorted([*ROOT.glob("*.lock"), *ROOT.glob("[!.]*/*.lock")])

FORBIDDEN_MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"}
FORBIDDEN_BUILTINS = {"eval", "exec", "__import__"}
FORBIDDEN_CALLS = {"os.system", "os.popen", "subprocess.getoutput", "subprocess.getstatusoutput"}
# Whatever they are called on.
FORBIDDEN_METHODS = {"read_pickle", "to_pickle", "unsafe_load", "full_load", "unsafe_load_all", "full_load_all"}
# Rules are not quite Python; in them, a word is enough.
FORBIDDEN_IN_RULES = {
    *FORBIDDEN_MODULES,
    *FORBIDDEN_BUILTINS,
    *FORBIDDEN_METHODS,
    *(name.split(".")[1] for name in FORBIDDEN_CALLS),
    "shell",
    "subprocess",
}


def findings(source: str) -> list[str]:
    """What in a source is refused, each with its line."""
    tree = ast.parse(source)
    origins = imported(tree)
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            found += [f"{node.lineno}: import {name}" for name in names if name.split(".")[0] in FORBIDDEN_MODULES]
        if isinstance(node, ast.Call):
            head, dot, rest = ast.unparse(node.func).partition(".")
            name = origins.get(head, head) + dot + rest
            if _is_refused(name, {keyword.arg: ast.unparse(keyword.value) for keyword in node.keywords}):
                found.append(f"{node.lineno}: {name}")
    return found


def imported(tree: ast.AST) -> dict[str, str]:
    """What each imported name stands for: pd -> pandas, system -> os.system."""
    origins = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            origins |= {alias.asname: alias.name for alias in node.names if alias.asname}
        elif isinstance(node, ast.ImportFrom):
            origins |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    return origins


def _is_refused(name: str, options: dict[str | None, str]) -> bool:
    loader = options.get("Loader", "")
    return (
        name.removeprefix("builtins.") in FORBIDDEN_BUILTINS
        or name in FORBIDDEN_CALLS
        or name.split(".")[-1] in FORBIDDEN_METHODS
        or options.get("shell", "False") != "False"
        or options.get("allow_pickle", "False") != "False"
        or (name in ("yaml.load", "yaml.load_all") and "Safe" not in loader and loader != "_LOADER")
    )


def findings_in_rules(source: str) -> list[str]:
    """The refused words of a file of rules, each with its line; comments and text do not count."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return [f"{token.start[0]}: {token.string}" for token in tokens if token.string in FORBIDDEN_IN_RULES]


@pytest.mark.parametrize(
    "line",
    [
        "import pickle",
        "from joblib import load",
        "eval('1')",
        "import builtins; builtins.exec('1')",
        "__import__('pickle')",
        "import os; os.system('x')",
        "from os import system; system('x')",
        "from os import popen as start; start('x')",
        "import subprocess as s; s.getoutput('x')",
        "subprocess.run('x', shell=True)",
        "subprocess.run('x', shell=1)",
        "subprocess.run('x', shell=wanted)",
        "np.load('x', allow_pickle=1)",
        "import pandas; pandas.read_pickle('x')",
        "import pandas as pd; pd.read_pickle('x')",
        "from pandas import read_pickle; read_pickle('x')",
        "table.to_pickle('x')",
        "yaml.load(text)",
        "from yaml import load; load(text)",
        "import yaml as y; y.load(text, Loader=y.UnsafeLoader)",
    ],
)
def test_the_search_finds_what_it_looks_for(line):
    assert findings(line)


@pytest.mark.parametrize(
    "line",
    [
        "yaml.load(text, Loader=yaml.CSafeLoader)",
        "subprocess.run(['x'], shell=False)",
        "np.load('x', allow_pickle=False)",
        "json.load(file)",
    ],
)
def test_the_search_lets_pass_what_is_safe(line):
    assert findings(line) == []


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_unpickles_evaluates_or_goes_through_a_shell(path):
    assert findings(path.read_text()) == []


@pytest.mark.parametrize(
    "text",
    [
        "rule a:\n    shell:\n        'rm {params.x}'\n",
        "rule a:\n    run:\n        shell('rm {params.x}')\n",
        "import pickle\n",
        "from os import system as start\n",
        "table = pandas.read_pickle('x')\n",
    ],
)
def test_the_search_in_rules_finds_what_it_looks_for(text):
    assert findings_in_rules(text)


def test_the_search_in_rules_lets_pass_what_is_only_told():
    assert findings_in_rules("# no shell\nrule shells:\n    log:\n        'shell'\n") == []


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_no_rule_goes_through_a_shell_unpickles_or_evaluates(path):
    assert findings_in_rules(path.read_text()) == []


def test_every_lock_file_of_the_checkout_is_looked_at():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "*.lock"], capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    assert {str(path.relative_to(ROOT)) for path in LOCKS} >= set(listed.stdout.split())
    assert len(LOCKS) > 1


@pytest.mark.parametrize("path", LOCKS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_locked_package_has_a_hash_and_no_address(path):
    text = path.read_text()
    assert "://" not in text
    for requirement in re.split(r"\n(?=\S)", text.strip()):
        if not requirement.startswith("#"):
            assert re.match(r"[\w.\[\],-]+==\S+", requirement), requirement[:80]
            assert "--hash=sha256:" in requirement, requirement[:80]
