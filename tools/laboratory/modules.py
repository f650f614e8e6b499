"""The WebAssembly modules of the page: one for each model and what is baked into its C."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

from jointfmu_fmu_src.native.compiler import webassembly
from jointfmu_fmu_src.native.kept import keeping

from jointfmu.joints import KINDS
from jointfmu.joints.kind import Kind
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, dump, load

from ..joint_parts import part

_OWN = "laboratory.c"
_MAP = "map.c"
_GENERATES = Lock()


@dataclass(frozen=True, slots=True)
class Module:
    """A model with the parameter files that share its C; the first one gives its start values."""

    model: Model
    files: Sequence[ParameterFile]

    @property
    def map(self) -> Path | None:
        """C that shows the contact, if the part `laboratory` has it; need not be there."""
        bench = part(KINDS[self.model.joint], "laboratory")
        return Path(str(bench.__file__)).with_name(_MAP) if bench else None

    def sources(self) -> dict[str, str]:
        """{file name: text} of all C sources: those of the FMU, and what the page calls."""
        # needs casadi, pages of the report do not
        from jointfmu_fmu_src.native.generate import sources, token

        files = sources(self.model.name, self.files[0])
        return files | self._added() | {"token.h": f'#define TOKEN "{token(files)}"\n'}

    def compiled(self) -> bytes:
        """The module, a reactor without imports; its functions are those of laboratory.c.

        Raises ImportError if ziglang is missing, RuntimeError with the compiler's first error.
        """
        return keeping(f"{dump(self.files[0])} {self._added()}", self.model, self._compiled)

    def _added(self) -> dict[str, str]:
        """{file name: text} of what the page calls."""
        own = [Path(__file__).with_name(_OWN), *([self.map] if self.map and self.map.is_file() else [])]
        return {path.name: path.read_text(encoding="utf-8") for path in own}

    def _compiled(self) -> bytes:
        with _GENERATES:  # casadi knows no threads
            files = self.sources()
        units = [name for name in files if name.endswith(".c") and not name.startswith("fmi")]
        return webassembly(self.model.name, files, units)


def modules() -> list[Module]:
    """Those of all joints and shipped parameter files, in the order in which they are shown."""
    return [module for kind in KINDS.values() for model in kind.models for module in _of(kind, model)]


def compiled(some: Sequence[Module]) -> list[bytes]:
    """The modules in binary form."""
    with ThreadPoolExecutor() as pool:
        return list(pool.map(Module.compiled, some))


def _of(kind: Kind, model: Model) -> Iterator[Module]:
    groups: dict[tuple[object, ...], list[ParameterFile]] = {}
    for file in _files(kind):
        groups.setdefault(_baked(model.of(kind.name, file.values), file), []).append(file)
    for files in groups.values():
        yield Module(model.of(kind.name, files[0].values), files)


def _files(kind: Kind) -> list[ParameterFile]:
    """The shipped files of a joint, the default one first."""
    default = kind.default_file()
    return [
        load(path, kind.name) for path in sorted(default.parent.glob("*.toml"), key=lambda p: p != default)
    ]


def _baked(model: Model, file: ParameterFile) -> tuple[object, ...]:
    """What the C of a model has of a parameter file that cannot be set: two files with the same share it."""
    exposed = model.parameter_fields()
    return file.law, tuple((name, value) for name, value in file.flat.items() if name not in exposed)
