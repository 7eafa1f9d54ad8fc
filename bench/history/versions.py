"""The versions of a history: releases of a package on its registry, commits of the suite, or records on a branch."""

from __future__ import annotations

import json
from collections.abc import Sequence

from packaging.version import InvalidVersion, Version

from bench.compare.commands import PYTHON, UV, call
from bench.machine.source_digest import ROOT

_RANGE = ".."


class VersionsError(ValueError):
    """Error for a wrong choice of versions; the message names the fix."""


def released(package: str, wanted: str) -> list[str]:
    """Return the wanted releases of a package, in rising order.

    Args:
        package: name of the package.
        wanted: ``all``, a range ``3.0..4.0``, or a list ``3.3.0,4.0.0``. Either end of a range may be missing. The
            upper end 4.0 includes releases such as 4.0.1. ``all`` and ranges contain only final releases with a wheel
            for this machine. The function does not check that the releases of a list exist.

    Raises:
        CheckoutError: if the query of the registry fails.
        VersionsError: if ``wanted`` is malformed, or a range contains no release.
    """
    if wanted != "all" and _RANGE not in wanted:
        return [str(version) for version in sorted(map(_parsed, wanted.split(",")))]
    command = [UV, "tool", "run", "--quiet", "pip", "index", "versions", package, "--json"]
    query = [*command, "--only-binary", ":all:", "--python-version", PYTHON]
    answer = call(package, query, ROOT, "connect to the registry, or list the releases, such as --versions 3.3.0,4.0.0")
    versions = sorted(Version(text) for text in json.loads(answer)["versions"])
    return [str(version) for version in within(versions, wanted)]


def within(versions: Sequence[Version], wanted: str) -> list[Version]:
    """Return the versions in a range such as ``3.0..4.0``, or all versions if ``wanted`` is ``all``.

    A range to 4.0 includes versions such as 4.0.1.

    Raises:
        VersionsError: if ``wanted`` is malformed, or no version is in the range.
    """
    if wanted == "all":
        return list(versions)
    low, _, high = wanted.partition(_RANGE)
    least = _parsed(low) if low else None
    greatest = _parsed(high) if high else None
    found = [
        version
        for version in versions
        if (least is None or version >= least)
        and (greatest is None or version <= greatest or version.release[: len(greatest.release)] == greatest.release)
    ]
    if not found:
        fix = f"a range within {versions[0]}..{versions[-1]}" if versions else "another engine"
        raise VersionsError(
            f"--versions {wanted} must contain a release with a wheel for this machine, but contains none: choose {fix}"
        )
    return found


def commits(wanted: str) -> list[str]:
    """Return the short names of the suite's commits from A to B along first parents, with A and B, oldest first.

    Raises:
        CheckoutError: if git is missing, or does not know A or B.
        VersionsError: if ``wanted`` is not ``A..B``, or contains no commit after A.
    """
    low, separator, high = wanted.partition(_RANGE)
    if not (low and separator and high):
        raise VersionsError(f"--commits must be a range A..B, got {wanted!r}: give a range such as v0.1.0..HEAD")
    fix = "name commits, branches or tags in --commits A..B"
    first = call(low, ["git", "rev-parse", "--verify", "--end-of-options", f"{low}^{{commit}}"], ROOT, fix).strip()
    listed = call(wanted, ["git", "rev-list", "--first-parent", "--reverse", "--end-of-options", wanted], ROOT, fix)
    if not listed:
        raise VersionsError(
            f"--commits {wanted} must contain a commit after {low}, but contains none: name two different commits, "
            "the older commit first"
        )
    return [commit[:12] for commit in (first, *listed.split())]


def kept_records(wanted: str) -> list[tuple[str, bytes]]:
    """Return name (date and commit) and content of each version of a baseline file on a branch, oldest first.

    Args:
        wanted: the branch and the file, as ``BRANCH:PATH``.

    Raises:
        CheckoutError: if git is missing, or does not know the branch.
        VersionsError: if ``wanted`` is malformed, or no commit adds or changes the file.
    """
    branch, separator, path = wanted.partition(":")
    if not (branch and separator and path):
        raise VersionsError(
            f"--records must be BRANCH:PATH, such as records:stacking.json, got {wanted!r}: give a branch, ':' and "
            "a path"
        )
    log = ["git", "log", "--first-parent", "--reverse", "--format=%H %cs", "--diff-filter=AM", branch, "--", path]
    lines = [line.split() for line in call(branch, log, ROOT, "name a branch in --records BRANCH:PATH").splitlines()]
    if not lines:
        raise VersionsError(
            f"--records {wanted}: no commit of {branch} adds or changes the file {path}: correct the path, or commit "
            "a file of 'bench baseline' there"
        )
    shown = [(commit, date, call(branch, ["git", "show", f"{commit}:{path}"], ROOT)) for commit, date in lines]
    return [(f"{date} {commit[:10]}", content.encode()) for commit, date, content in shown]


def _parsed(text: str) -> Version:
    try:
        return Version(text.strip())
    except InvalidVersion:
        raise VersionsError(
            f"--versions: {text!r} is not a version; give all, a range such as 3.0..4.0, or a list such as 3.3.0,4.0.0"
        ) from None
