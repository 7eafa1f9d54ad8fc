"""Resolve the packages of an environment: the packages of the lock file, except the packages that the user chooses.

A chosen package overrides every other demand for this package. The resolver prefers the locked version of every other
package, and changes a version only where a chosen package needs another version. The module does not install a chosen
package over the locked environment, because the package could meet unsupported versions and remains of the replaced
release.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from packaging.markers import Marker
from packaging.requirements import InvalidRequirement, Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

from adapters.engines import ENGINES
from bench.compare.commands import PYTHON, UV, CheckoutError, call

ENGINES_GROUP = "engines"
"""Dependency group with the engines' packages, of which an environment contains only the study's engines."""
_GROUPS = ("suite", "cluster", "reports", "video")
"""Dependency groups that ``bench run`` may import."""
_OPTIONAL_GROUPS = {"ode": "ode", "jolt": "wasm", "havok": "wasm"}
"""Dependency groups of engines whose packages are not in ``ENGINES_GROUP``."""
_PLAIN = ("--no-annotate", "--no-header", "--quiet")
"""Options of uv for requirements without comments."""
_COMPANIONS = (
    # SAPIEN imports pkg_resources, which setuptools 81 removed.
    ("sapien", SpecifierSet(), ("setuptools<81",)),
    # These wheels need NumPy 1, which later releases of pandas and pyarrow reject at import.
    ("pybullet", SpecifierSet("<3.2.7"), ("numpy<2", "pandas<3", "pyarrow<22")),
)
"""Demands of some releases that their metadata does not state: package, releases, and other packages."""


def pinned(
    name: str, suite: Path, engines: Iterable[str], packages: Sequence[str] = (), *, build: bool = True
) -> list[str]:
    """Return the requirements of an environment, each with its version, sorted.

    Args:
        name: the side of the comparison, for messages.
        suite: folder of the checkout, with ``pyproject.toml`` and ``uv.lock``.
        engines: names of the engines whose packages to install.
        packages: chosen packages: requirements such as ``mujoco==3.3.0``, wheels, or folders with sources.
        build: False to accept wheels only.

    Raises:
        CheckoutError: if no versions satisfy all requirements, a chosen package is invalid, or the lock file is not up
            to date.
    """
    engines = sorted(set(engines))
    project = tomllib.loads((suite / "pyproject.toml").read_text(encoding="utf-8"))
    chosen = [_named(name, suite, package) for package in packages]
    optional = {_OPTIONAL_GROUPS[engine] for engine in engines if engine in _OPTIONAL_GROUPS}
    known = project["dependency-groups"]
    wanted = [group for group in (*_GROUPS, *sorted(optional)) if group in known]
    demands = [*project["project"]["dependencies"], *(demand for group in wanted for demand in known[group])]
    demands += _of_engines(known[ENGINES_GROUP], engines)
    chosen += [companion for package in list(chosen) for companion in _companions(Requirement(package))]
    demands += chosen
    overrides = [*project["tool"]["uv"].get("override-dependencies", ()), *chosen]
    with TemporaryDirectory() as scratch:
        paths = [Path(scratch, part) for part in ("demands.in", "overrides.txt", "pinned.txt")]
        locked = _locked(name, suite, [*wanted, ENGINES_GROUP])
        for path, lines in zip(paths, (demands, overrides, locked), strict=True):
            path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        demanded, overriding, out = map(str, paths)
        command = [UV, "pip", "compile", demanded, "--override", overriding, "-o", out, "--python-version", PYTHON]
        fix = f"no set of packages fits {', '.join(packages) or 'the lock file'}; choose another version"
        call(name, [*command, *([] if build else ["--no-build"]), *_PLAIN], suite, fix)
        return sorted(paths[2].read_text(encoding="utf-8").split("\n"))[1:]


def _companions(chosen: Requirement) -> Iterator[str]:
    """Yield the demands of ``_COMPANIONS`` for a chosen package; without an exact version, assume release 99."""
    exact = [clause.version for clause in chosen.specifier if clause.operator == "=="]
    for package, releases, companions in _COMPANIONS:
        if canonicalize_name(chosen.name) == package and any(releases.contains(release) for release in exact or ["99"]):
            yield from companions


def _of_engines(group: Iterable[str], engines: Sequence[str]) -> Iterator[str]:
    """Yield the packages of the engines among the requirements of a group."""
    packages = {canonicalize_name(getattr(ENGINES[engine], "package", engine)) for engine in engines}
    return (demand for demand in group if canonicalize_name(Requirement(demand).name) in packages)


def _named(name: str, suite: Path, package: str) -> str:
    """Return a package as a requirement with a name; uv finds the name of a wheel or a folder."""
    if not Path(package).exists():
        try:
            return str(Requirement(package))
        except InvalidRequirement as error:
            raise CheckoutError(
                f"{name}: {package!r} is neither a file nor a requirement such as 'mujoco==3.3.0' "
                f"({str(error).splitlines()[0]}): "
                "correct the path or the requirement"
            ) from error
    with TemporaryDirectory() as scratch:
        demanded = Path(scratch, "demands.in")
        demanded.write_text(f"{Path(package).resolve()}\n", encoding="utf-8")
        command = [UV, "pip", "compile", str(demanded), "--no-deps", *_PLAIN]
        fix = "name a wheel, or a folder that can be built"
        lines = call(name, command, suite, fix).split("\n")
    return next(line for line in lines if line.strip())


def _locked(name: str, suite: Path, groups: Sequence[str]) -> list[str]:
    """Return the locked packages of the groups, without packages for other machines."""
    options = [option for group in groups for option in ("--group", group)]
    plain = ["--no-hashes", "--no-emit-project", "--no-default-groups", *_PLAIN]
    text = call(name, [UV, "export", "--locked", *plain, *options], suite, "run 'uv lock' in this version")
    pins = []
    for line in text.splitlines():
        pin, _, marker = line.partition(" ; ")
        if not marker or Marker(marker).evaluate():
            pins.append(pin.strip())
    return pins
