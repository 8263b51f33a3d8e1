"""What the sources must not contain, and what the lock files must."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Benchmarks are left out: one compares with unpickling a file that it wrote itself.
SOURCES = sorted([*(ROOT / "src").rglob("*.py"), *(ROOT / "workflow").rglob("*.py")])
RULES = sorted((ROOT / "workflow/rules").glob("*.smk"))
LOCKS = sorted([*ROOT.glob("requirements*.lock"), *ROOT.glob("tests/*.lock"), *ROOT.glob("benchmarks/*.lock")])

FORBIDDEN_MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"}
FORBIDDEN_CALLS = {"eval", "exec", "os.system", "os.popen", "yaml.unsafe_load", "yaml.full_load", "pd.read_pickle"}


def findings(source: str) -> list[str]:
    """What in a source is refused, each with its line."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            found += [f"{node.lineno}: import {name}" for name in names if name.split(".")[0] in FORBIDDEN_MODULES]
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            options = {keyword.arg: ast.unparse(keyword.value) for keyword in node.keywords}
            unsafe_yaml = name == "yaml.load" and "Safe" not in options.get("Loader", "") and options.get("Loader") != "_LOADER"
            if name in FORBIDDEN_CALLS or options.get("shell") == "True" or options.get("allow_pickle") == "True" or unsafe_yaml:
                found.append(f"{node.lineno}: {name}")
    return found


@pytest.mark.parametrize(
    "line", ["import pickle", "from joblib import load", "eval('1')", "subprocess.run('x', shell=True)", "yaml.load(text)"]
)
def test_the_search_finds_what_it_looks_for(line):
    assert findings(line)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_unpickles_evaluates_or_goes_through_a_shell(path):
    assert findings(path.read_text()) == []


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_shell_commands_of_rules_hold_file_names_only(path):
    for block in re.findall(r"shell:\s*\n((?:\s+[\"'].*\n)+)", path.read_text()):
        fields = set(re.findall(r"(?<!{){([a-z_.]+)", block))
        assert {field.split(".")[0] for field in fields} <= {"input", "output", "log", "threads"}


@pytest.mark.parametrize("path", LOCKS, ids=lambda path: path.name)
def test_every_locked_package_has_a_hash_and_no_address(path):
    text = path.read_text()
    assert "://" not in text
    for requirement in re.split(r"\n(?=\S)", text.strip()):
        if not requirement.startswith("#"):
            assert re.match(r"[\w.\[\],-]+==\S+", requirement), requirement[:80]
            assert "--hash=sha256:" in requirement, requirement[:80]
