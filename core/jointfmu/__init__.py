"""Stiffness, friction and damping of mechanical joints, as laws, curves and FMUs.

    import jointfmu

    drive = jointfmu.drive("CSG-25-100")       # a harmonic drive by its name in the catalogue
    drive.wind_up(48.0)                        # rad under 48 N.m
    drive.build("dist")                        # FMUs for any simulator
    jointfmu.load("my_joint.toml").report("my_joint.html")

All numbers are in SI units; arguments taken from a drawing (plate, grip, Ra, ...) have their own units.
"""

from typing import Any

from .version import __version__ as __version__

__all__ = [
    "Fit",
    "Frame",
    "Joint",
    "Law",
    "SystemFit",
    "Table",
    "bolted_joint",
    "cycloidal_drive",
    "drive",
    "fit",
    "fit_system",
    "gear_contact",
    "gear_mesh",
    "law",
    "load",
    "run",
]


def __getattr__(attribute_name: str) -> Any:
    """Import a name of the public interface from `jointfmu_tools.api` on first access."""
    if attribute_name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {attribute_name!r}")
    try:
        from jointfmu_tools import api
    except ModuleNotFoundError as error:
        if error.name != "jointfmu_tools":
            raise
        raise ImportError(
            f"jointfmu.{attribute_name} needs the package jointfmu_tools, which is missing; "
            "install both with: pip install jointfmu"
        ) from None
    value = globals()[attribute_name] = getattr(api, attribute_name)
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
