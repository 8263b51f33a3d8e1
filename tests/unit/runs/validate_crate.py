"""Validate a crate against the Workflow Run Crate profile without a network; run by the validator's own Python.

The one document that the validator would fetch is the JSON-LD context of RO-Crate 1.1. The package rocrate ships that of
version 1.3, in which four terms of Bioschemas have moved; they are put back where version 1.1 has them.
"""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import rocrate
from rocrate_validator import services
from rocrate_validator.utils import document_loader
from rocrate_validator.utils.http import HttpRequester

BIOSCHEMAS = "https://bioschemas.org"
CONTEXT = json.loads((Path(rocrate.__file__).parent / "data/ro-crate.jsonld").read_text())
CONTEXT["@context"] |= {
    "ComputationalWorkflow": f"{BIOSCHEMAS}/ComputationalWorkflow",
    "FormalParameter": f"{BIOSCHEMAS}/FormalParameter",
    "input": f"{BIOSCHEMAS}/ComputationalWorkflow#input",
    "output": f"{BIOSCHEMAS}/ComputationalWorkflow#output",
}


def context_only(self, address, **options):
    """The context for its address; nothing else is to be had."""
    found = address == "https://w3id.org/ro/crate/1.1/context"
    kind = {"Content-Type": "application/ld+json"}
    return SimpleNamespace(status_code=200 if found else 404, ok=found, headers=kind, json=lambda: CONTEXT)


HttpRequester.get = context_only
document_loader.install_document_loader()
settings = services.ValidationSettings(
    rocrate_uri=sys.argv[1], profile_identifier="workflow-run-crate", skip_availability_check=True
)
issues = services.validate(settings).get_issues()
for issue in issues:
    print(f"{issue.check.identifier}: {issue.message}")
sys.exit(len(issues) > 0)
