"""Which folders are packages: found, so that adding a joint is adding folders. The rest: pyproject.toml."""

from setuptools import find_packages, setup

ROOTS = {
    "jointfmu": "core/jointfmu",
    "jointfmu_fmu_src": "fmu_src",
    "jointfmu_tools": "tools",
    "jointfmu_models": "models",
}
"""{import name: folder}."""

setup(
    packages=[
        name
        for root, folder in ROOTS.items()
        for name in (root, *(f"{root}.{inner}" for inner in find_packages(folder)))
    ],
    package_dir=ROOTS,
)
