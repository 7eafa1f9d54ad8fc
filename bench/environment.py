"""Where a run took place: versions, machine, commit, and what each engine gives and how its profiles are set."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import psutil

from adapters import ENGINES, Profile, capabilities, profiles
from stability_core import Settings

ROOT = Path(__file__).parent.parent
_PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "pebble")


def engine_version(engine: str) -> str:
    """Version of the engine's package."""
    return importlib.metadata.version(ENGINES[engine].package)


def describe(engines: Iterable[str]) -> dict[str, Any]:
    """What environment.json holds; the same on the same machine at the same commit."""
    return {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processor": _processor(),
        "cores": psutil.cpu_count(logical=False),
        "threads": os.cpu_count(),
        "memory_gib": round(psutil.virtual_memory().total / 2**30, 1),
        "packages": {name: importlib.metadata.version(name) for name in _PACKAGES},
        "lock_sha256": hashlib.sha256((ROOT / "uv.lock").read_bytes()).hexdigest(),
        "commit": _git("rev-parse", "HEAD"),
        "modified": bool(_git("status", "--porcelain", "--untracked-files=no")),
        "settings": asdict(Settings()),
        "engines": {
            name: {
                "version": engine_version(name),
                "capabilities": asdict(capabilities(name)),
                "profiles": {key: _profile(profile) for key, profile in profiles(name).items()},
            }
            for name in engines
        },
    }


def digest(environment: Mapping[str, Any]) -> str:
    """Short digest by which a record names its environment."""
    canonical = json.dumps(environment, sort_keys=True, default=str).encode()
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


def _git(*arguments: str) -> str | None:
    """Output of a git command in this checkout; None where there is no git or no checkout."""
    try:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True, timeout=10)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
