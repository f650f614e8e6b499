"""What a joint's folder says of measured natural frequencies, for `jointfmu validate --frequencies`."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path


@dataclass(frozen=True, slots=True)
class MeasuredFrequencies:
    """Frequencies of a bolted assembly: `FREQUENCIES` of the file frequencies.py in a clamped joint's folder.

    points   : file of published numbers in models/reference/; `where` of each has `preload` [N] per bolt,
               `moment` [N.m] and `mode`, from 1
    assembly : file in models/assemblies/
    """

    points: str
    assembly: str

    @property
    def path(self) -> Path:
        """Of the assembly's file."""
        return Path(str(files("jointfmu_models") / "assemblies" / f"{self.assembly}.toml"))
