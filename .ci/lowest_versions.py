"""Check that the installed version of every declared dependency is the lowest one that is declared."""

import sys
import tomllib
from importlib.metadata import version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version

EXTRA = "test"
"""The extra that takes all others but those of maintainers."""


def requirements(project: dict, extra: str) -> list[Requirement]:
    """Requirements of the project with one extra and all extras that this one names."""
    found = []
    for line in project["optional-dependencies"][extra]:
        requirement = Requirement(line)
        if requirement.name == project["name"]:
            found += [r for other in sorted(requirement.extras) for r in requirements(project, other)]
        else:
            found.append(requirement)
    return found


def main() -> int:
    """Print each dependency whose lowest version is not the installed one; 1 if there is one."""
    text = (Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    project = tomllib.loads(text)["project"]
    declared = [*map(Requirement, project["dependencies"]), *requirements(project, EXTRA)]
    status = 0
    for requirement in declared:
        if requirement.marker and not requirement.marker.evaluate():
            continue
        (lowest,) = (s.version for s in requirement.specifier if s.operator in (">=", "==", "~="))
        installed = version(requirement.name)
        if Version(installed) != Version(lowest):
            print(f"{requirement}: {installed} is installed; declare the version that is tested")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
