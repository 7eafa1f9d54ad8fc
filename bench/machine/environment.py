"""The environment of a run: versions, machine, commit, and the capabilities and profiles of each engine."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import platform
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import psutil

from adapters import Profile, capabilities, engine_version, missing_knobs, profiles
from bench.machine.checkout import head, is_modified
from bench.machine.core_digest import present_core
from bench.machine.instructions import availability
from bench.machine.source_digest import ROOT, SUITE, sources_digest
from stability_core import Settings

_PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "pebble")


def describe(engines: Iterable[str]) -> dict[str, Any]:
    """Return the environment that all trials of a run share, as JSON values.

    The environment depends only on the engines, the machine, its packages and the checkout, not on the time.

    Raises:
        UnknownNameError: if no engine has one of the names.
        EngineNotInstalledError: if an engine does not load.
    """
    environment = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processor": _processor(),
        "cores": psutil.cpu_count(logical=False),
        "threads": os.cpu_count(),
        "memory_gib": round(psutil.virtual_memory().total / 2**30, 1),
        "packages": {name: importlib.metadata.version(name) for name in _PACKAGES},
        "lock_sha256": hashlib.sha256((ROOT / "uv.lock").read_bytes()).hexdigest(),
        "commit": head(),
        "modified": is_modified(),
        "sources": sources_digest(SUITE),
        "core": present_core(),
        "settings": asdict(Settings()),
        "engines": {name: describe_engine(name) for name in engines},
    }
    plain: dict[str, Any] = json.loads(json.dumps(environment))
    return plain


def describe_engine(name: str) -> dict[str, Any]:
    """Return version, capabilities, profiles and, if any, missing knobs of one engine.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the engine does not load.
    """
    shown = capabilities(name)  # loads the engine, so that a missing package raises EngineNotInstalledError
    description = {
        "version": engine_version(name),
        "capabilities": asdict(shown),
        "profiles": described_profiles(name),
    }
    missing = missing_knobs(name)
    return {**description, "missing_knobs": missing} if missing else description


def described_profiles(name: str) -> dict[str, dict[str, Any]]:
    """Return the description of each profile of an engine, by name.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the engine does not load.
    """
    return {key: _profile(profile) for key, profile in profiles(name).items()}


def session() -> dict[str, Any]:
    """Return the present state of the machine, which a run records when it starts or continues."""
    return {
        "host": platform.node(),
        "begun": datetime.now(UTC).isoformat(timespec="seconds"),
        "load": [round(load, 2) for load in psutil.getloadavg()],
        "governor": _governor(),
        "cores_allowed": sorted(allowed_cores()),
        "instructions": availability(),
    }


def allowed_cores() -> set[int]:
    """Return the indices of the cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):  # Linux only
        return os.sched_getaffinity(0)
    return set(range(os.cpu_count() or 1))


def digest(environment: Mapping[str, Any]) -> str:
    """Return the digest that identifies an environment in records, as 12 hexadecimal digits."""
    canonical = json.dumps(environment, sort_keys=True).encode()
    return hashlib.blake2b(canonical, digest_size=6).hexdigest()


def _profile(profile: Profile) -> dict[str, Any]:
    return {
        "description": profile.description,
        "substeps": profile.substeps,
        "frame_s": profile.frame_s,
        "tuned_by": profile.tuned_by,
        "knobs": {name: {"value": knob.value, "reason": knob.reason} for name, knob in profile.knobs.items()},
    }


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _governor() -> str | None:
    """Return the frequency governor of the processor; None if the system reports no governor."""
    file = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")
    return file.read_text(encoding="utf-8").strip() if file.exists() else None
