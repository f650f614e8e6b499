"""Build backend of the distribution: setuptools, with the packages of all folders. pyproject.toml names it.

All packages below the root folders are included, so a new joint needs new folders only. The environment
variable JOINTFMU_URL is the address of the repository; the release workflow sets it. If it is set, the
distribution has project URLs, and relative links of the README become links to the repository.

Builders and commands do not use this module.
"""

import base64
import hashlib
import os
import re
import zipfile
from functools import partial
from pathlib import Path
from typing import Any

import setuptools
from setuptools import build_meta
from setuptools.build_meta import (
    build_sdist,
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

PACKAGE_SOURCE_FOLDERS = {
    "jointfmu": "core/jointfmu",
    "jointfmu_fmu_src": "fmu_src",
    "jointfmu_tools": "tools",
    "jointfmu_models": "models",
}
"""Import names of the packages of the distribution, with their folders in the repository."""
CORE_PACKAGE_FOLDER = "core"
"""Folder of the package `jointfmu` (laws and joints), for the module search path of an editable wheel."""
PROJECT_URL_PATHS = {
    "Documentation": "/tree/HEAD/docs",
    "Changelog": "/blob/HEAD/CHANGELOG.md",
    "Issues": "/issues",
}
"""{label of a project URL: path below the address of the repository}."""


def make_long_description(readme_text: str, repository_url: str) -> str:
    """Long description of the package: the README, with links to the repository if its URL is given."""
    if not repository_url:
        return readme_text
    readme_text = re.sub(r"(!\[[^\]]*\]\()(?!https?:)", rf"\g<1>{repository_url}/raw/HEAD/", readme_text)
    return re.sub(r"((?<!!)\[[^\]]*\]\()(?!https?:|#)", rf"\g<1>{repository_url}/blob/HEAD/", readme_text)


def make_setuptools_arguments() -> dict[str, Any]:
    """Arguments of `setuptools.setup` that pyproject.toml does not have; the working folder is the root."""
    url = os.environ.get("JOINTFMU_URL", "").rstrip("/")
    return {
        "packages": [
            name
            for root, folder in PACKAGE_SOURCE_FOLDERS.items()
            for name in (root, *(f"{root}.{inner}" for inner in setuptools.find_packages(folder)))
        ],
        "package_dir": PACKAGE_SOURCE_FOLDERS,
        "long_description": make_long_description(Path("README.md").read_text(encoding="utf-8"), url),
        "long_description_content_type": "text/markdown",
        "project_urls": {"Repository": url, **{n: url + path for n, path in PROJECT_URL_PATHS.items()}}
        if url
        else {},
    }


def build_editable(
    wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None
) -> str:
    """Build the editable wheel of setuptools, with the folder of the package `jointfmu` on the search path.

    Setuptools finds the packages by an import hook, which comes after the search path. So Python would first
    find a clone of the repository in a folder `jointfmu`, and import this folder as a namespace package.
    """
    name: str = build_meta.build_editable(wheel_directory, config_settings, metadata_directory)
    _append_search_path(Path(wheel_directory, name), Path(CORE_PACKAGE_FOLDER).resolve())
    return name


def _append_search_path(wheel_path: Path, module_folder: Path) -> None:
    """Append a folder of modules to the module search path file (.pth) of an editable wheel."""
    with zipfile.ZipFile(wheel_path) as archive:
        contents = {item: archive.read(item) for item in archive.infolist()}
    (search_path,) = (item for item in contents if item.filename.endswith(".pth"))
    (record,) = (item for item in contents if item.filename.endswith(".dist-info/RECORD"))
    text = contents[search_path].rstrip() + f"\n{module_folder}\n".encode()
    digest = base64.urlsafe_b64encode(hashlib.sha256(text).digest()).rstrip(b"=").decode()
    rows = contents[record].decode().splitlines()
    rows = [row for row in rows if not row.startswith(f"{search_path.filename},")]
    rows.append(f"{search_path.filename},sha256={digest},{len(text)}")
    contents |= {search_path: text, record: "".join(f"{row}\n" for row in rows).encode()}
    with zipfile.ZipFile(wheel_path, "w", zipfile.ZIP_DEFLATED) as archive:
        for item, content in contents.items():
            archive.writestr(item, content)


# the hooks of setuptools call `setup()` of a project without setup.py
setuptools.setup = partial(setuptools.setup, **make_setuptools_arguments())
