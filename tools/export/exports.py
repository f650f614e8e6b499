"""What a joint's part `export` says, EXPORTS: all that other solvers can be given of it; the formats.

Loads no part of scipy, nor do the parts until something is written: the command line asks what there is.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jointfmu.joints import KINDS
from jointfmu.joints.model import Variable
from jointfmu.quantity import flat_fields

from ..joint_parts import part

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from .mesh import Mesh
    from .placing import Placing, Springs
    from .tables import LoadTable


FORMS = {
    "ansys": ("springs",),
    "calculix": ("springs", "contact"),
    "abaqus": ("springs", "contact"),
    "modelica": ("curve",),
    "csv": ("springs", "contact", "curve"),
}
"""{format: what it can hold}."""
ROBOTS = ("mjcf", "urdf")
"""Formats of robots, which hold a drive."""
WHAT = ("springs", "contact", "curve")
ERROR = 1e-3
"""Largest error of a table's load [1] by straight lines, unless another is asked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadCurve:
    """Load over displacement of the whole joint.

    meaning : what the file holds, in words
    columns : displacement, load and stiffness
    name    : of the table in a Modelica file
    table   : (parameters, working point or None, largest error [1]) -> Table
    """

    meaning: str
    columns: Sequence[Variable]
    name: str
    table: "Callable[[Any, Any, float], LoadTable]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Exports:
    """What can be written of a joint; None: nothing of that sort.

    state   : its working point, a dataclass of declared quantities whose text names them; the first must
              be stated, the others are zero unless they are
    springs : (parameters, working point or None, the user's node pairs or None, placing) -> springs and
              from what they are, in words; a working point is None where the pairs state the pressure
    contact : parameters -> pressure [Pa] over approach [m], and lines that say more of it
    curve   : load over displacement; it needs the working point if there is one
    lacks   : {what: why it cannot be written and what can}
    """

    state: type[object] | None = None
    springs: "Callable[[Any, Any, Mesh | None, Placing], tuple[Springs, str]] | None" = None
    contact: "Callable[[Any], tuple[Curve, Sequence[str]]] | None" = None
    curve: LoadCurve | None = None
    lacks: Mapping[str, str] = field(default_factory=dict)

    @property
    def working_point(self) -> dict[str, str]:
        """{name: meaning with unit} of the quantities of the working point, the one that is needed first."""
        declared = flat_fields(self.state) if self.state else ()
        return {name: f"{item.metadata['doc']} [{item.metadata['unit']}]" for name, item in declared}


def of(joint: str) -> Exports:
    """What can be written of a joint."""
    found = part(KINDS[joint], "export")
    exports: Exports = found.EXPORTS if found else Exports()
    return exports


def able(what: str) -> list[str]:
    """The joints of which springs, contact or curve can be written."""
    return [joint for joint in KINDS if getattr(of(joint), what)]


def required(joint: str, what: str) -> Any:
    """A joint's springs, contact or curve; ValueError if it lacks them."""
    exports = of(joint)
    if what in exports.lacks:
        raise ValueError(f"the {what} of a {joint} cannot be exported: {exports.lacks[what]}")
    if not getattr(exports, what):
        raise ValueError(f"{what} of a {joint} cannot be written; allowed is a {', '.join(able(what))}")
    return getattr(exports, what)
