"""Run ``snakemake --lint`` and fail on anything but the missing environment of each rule.

The one environment of walklab is requirements.lock; a conda or container line per rule
would name a second one.
"""

import re
import subprocess
import sys

ALLOWED = "Specify a conda environment or container for each rule."
# A lint is a line that is not indented and ends in a colon, followed by indented advice.
TITLE = re.compile(r"^(?! )(.+?)(?: in line \d+)?:$", flags=re.MULTILINE)


def findings(text: str) -> list[str]:
    """The titles of the lints that are not allowed."""
    titles = TITLE.findall(text)
    return [title for title in titles if title != ALLOWED and not title.startswith("Lints for")]


if __name__ == "__main__":
    done = subprocess.run([sys.executable, "-m", "snakemake", "--lint"], capture_output=True, text=True, check=False)
    report = done.stdout + done.stderr
    if bad := findings(report):
        sys.exit("snakemake --lint:\n" + "\n".join(bad))
    if ALLOWED not in report and done.returncode:
        sys.exit(report)
