"""A JSON schema made from the models of a kind of file."""

from __future__ import annotations

import json
from typing import Any

from space_robot_bringup.experiment.experiment import file_schema
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.reproduce.manifest import Manifest


def made_schema(kind: str) -> str:
    """The text that is shipped for a kind of ``KINDS``."""
    models: dict[str, Any] = {
        "experiment": file_schema,
        "campaign": Campaign.model_json_schema,
        "paper": Manifest.model_json_schema,
    }
    return f"{json.dumps(models[kind](), indent=2)}\n"
