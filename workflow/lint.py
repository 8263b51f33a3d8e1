"""Run ``snakemake --lint`` and fail on anything but the missing environment of each rule.

The one environment of walklab is requirements.lock; a conda or container line per rule
would name a second one.
"""

import re
import subprocess
import sys

ALLOWED = "No explicit environment"


def findings(text: str) -> list[str]:
    """The lints of a report that are not allowed."""
    lints = re.findall(r"^ {4}\* (.+?)(?=^ {4}\* |^Lints for|\Z)", text, flags=re.MULTILINE | re.DOTALL)
    return [lint.strip() for lint in lints if not lint.strip().lower().startswith(ALLOWED.lower())]


if __name__ == "__main__":
    report = subprocess.run([sys.executable, "-m", "snakemake", "--lint"], capture_output=True, text=True, check=False)
    text = report.stdout + report.stderr
    bad = findings(text)
    if bad or ("Lints for" not in text and report.returncode):
        sys.exit("snakemake --lint:\n" + ("\n".join(bad) or text))
