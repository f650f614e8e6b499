"""Packages, project URLs and long description of the distribution; other metadata is in pyproject.toml.

All packages below the root folders are included, so a new joint needs new folders only. The environment
variable JOINTFMU_URL is the address of the repository; the release workflow sets it. If it is set, the
distribution has project URLs, and relative links of the README become links to the repository.
"""

import os
import re
from pathlib import Path

from setuptools import find_packages, setup

ROOTS = {
    "jointfmu": "core/jointfmu",
    "jointfmu_fmu_src": "fmu_src",
    "jointfmu_tools": "tools",
    "jointfmu_models": "models",
}
"""{import name: folder}."""
URL = os.environ.get("JOINTFMU_URL", "").rstrip("/")
PAGES = {"Documentation": "/tree/HEAD/docs", "Changelog": "/blob/HEAD/CHANGELOG.md", "Issues": "/issues"}
"""{label of a project URL: path below the address of the repository}."""


def description() -> str:
    """Text of the README; with JOINTFMU_URL its relative pictures and links are absolute URLs."""
    text = Path(__file__).with_name("README.md").read_text(encoding="utf-8")
    if not URL:
        return text
    text = re.sub(r"(!\[[^\]]*\]\()(?!https?:)", rf"\g<1>{URL}/raw/HEAD/", text)
    return re.sub(r"((?<!!)\[[^\]]*\]\()(?!https?:|#)", rf"\g<1>{URL}/blob/HEAD/", text)


setup(
    packages=[
        name
        for root, folder in ROOTS.items()
        for name in (root, *(f"{root}.{inner}" for inner in find_packages(folder)))
    ],
    package_dir=ROOTS,
    long_description=description(),
    long_description_content_type="text/markdown",
    project_urls={"Repository": URL, **{name: URL + path for name, path in PAGES.items()}} if URL else {},
)
