"""What is found or given when a distribution is built; the rest stands in pyproject.toml.

Packages are found, so that adding a joint is adding folders. The address of the repository is given by the
environment, JOINTFMU_URL (the release workflow states its own): with it the distribution has urls, and the
links of its description lead there.
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
"""{name: path at the address of the repository}."""


def description() -> str:
    """The README; its pictures and links, if an address is given, there."""
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
