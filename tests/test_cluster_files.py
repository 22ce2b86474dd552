"""The files for clusters: what Ray's own schema says, and what KubeRay asks of a RayJob."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from click.testing import CliRunner

from islands.cli import cli

FOLDER = Path(__file__).parents[1] / "islands" / "cluster"

POD = {
    "type": "object",
    "required": ["spec"],
    "properties": {
        "spec": {
            "type": "object",
            "required": ["containers"],
            "properties": {
                "containers": {
                    "type": "array",
                    "minItems": 1,
                    "items": {
                        "type": "object",
                        "required": ["name", "image", "resources"],
                        "additionalProperties": False,
                        "properties": {
                            key: {}
                            for key in ("name", "image", "ports", "env", "resources")
                        }
                        | {"volumeMounts": {"type": "array"}},
                    },
                }
            },
        }
    },
}  # fmt: skip

RAYJOB = {
    "type": "object",
    "required": ["apiVersion", "kind", "metadata", "spec"],
    "properties": {
        "apiVersion": {"const": "ray.io/v1"},
        "kind": {"const": "RayJob"},
        "spec": {
            "type": "object",
            "additionalProperties": False,
            "required": ["entrypoint", "rayClusterSpec"],
            "properties": {
                "entrypoint": {"type": "string"},
                "submissionMode": {"enum": ["K8sJobMode", "HTTPMode", "InteractiveMode"]},
                "backoffLimit": {"type": "integer"},
                "activeDeadlineSeconds": {"type": "integer"},
                "shutdownAfterJobFinishes": {"type": "boolean"},
                "ttlSecondsAfterFinished": {"type": "integer"},
                "runtimeEnvYAML": {"type": "string"},
                "rayClusterSpec": {
                    "type": "object",
                    "additionalProperties": False,
                    "required": ["headGroupSpec"],
                    "properties": {
                        "rayVersion": {"type": "string"},
                        "enableInTreeAutoscaling": {"type": "boolean"},
                        "headGroupSpec": {
                            "type": "object",
                            "additionalProperties": False,
                            "required": ["template"],
                            "properties": {
                                "rayStartParams": {"additionalProperties": {"type": "string"}},
                                "template": POD,
                            },
                        },
                        "workerGroupSpecs": {
                            "type": "array",
                            "items": {
                                "type": "object",
                                "additionalProperties": False,
                                "required": ["groupName", "template"],
                                "properties": {
                                    "groupName": {"type": "string"},
                                    "replicas": {"type": "integer"},
                                    "minReplicas": {"type": "integer"},
                                    "maxReplicas": {"type": "integer"},
                                    "rayStartParams": {"additionalProperties": {"type": "string"}},
                                    "template": POD,
                                },
                            },
                        },
                    },
                },
            },
        },
    },
}
"""The part of KubeRay's API (ray.io/v1) that the manifest uses, by its reference; unknown keys are
refused. The whole of it is the CRD of KubeRay's release."""


def loaded(name: str) -> dict[str, Any]:
    document: dict[str, Any] = yaml.safe_load((FOLDER / name).read_text(encoding="utf-8"))
    return document


def test_the_cluster_of_own_machines_fits_rays_schema() -> None:
    ray = pytest.importorskip("ray")
    schema = json.loads((Path(ray.__file__).parent / "autoscaler" / "ray-schema.json").read_text())
    jsonschema.validate(loaded("cluster.yaml"), schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(loaded("cluster.yaml") | {"workers": 3}, schema)


def test_ray_takes_the_cluster_of_own_machines() -> None:
    from ray.autoscaler._private.util import prepare_config, validate_config

    config = prepare_config(loaded("cluster.yaml"))
    validate_config(config)
    assert set(config["available_node_types"]) == {"local.cluster.node"}


def test_the_manifest_is_a_rayjob() -> None:
    jsonschema.validate(loaded("rayjob.yaml"), RAYJOB)


def test_the_manifest_runs_a_command_that_is_there() -> None:
    name, *arguments = loaded("rayjob.yaml")["spec"]["entrypoint"].split()
    assert name == "meshipelago"
    command = cli.commands[arguments[0]]
    context = command.make_context(arguments[0], arguments[1:])
    assert context.params["backend"] == "ray"
    assert context.params["resuming"]


def test_all_pods_have_the_version_that_is_pinned() -> None:
    spec = loaded("rayjob.yaml")["spec"]["rayClusterSpec"]
    lock = (FOLDER.parents[1] / "requirements.lock").read_text(encoding="utf-8")
    assert f"ray=={spec['rayVersion']}" in lock.replace("ray[default]==", "ray==")
    assert f"rayproject/ray:{spec['rayVersion']}" in (FOLDER / "Dockerfile").read_text()
    assert version("ray").split(".")[0] == spec["rayVersion"].split(".")[0]


def test_a_relative_folder_is_refused_within_a_ray_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAY_JOB_CONFIG_JSON_ENV_VAR", "{}")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(cli, ["optimize", "part.bdf", "--out", "run"])
    assert "name an absolute path" in str(result.exception)
    assert not list(tmp_path.iterdir())
