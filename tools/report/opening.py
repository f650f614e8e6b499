"""The opening paragraph of a joint's page, in words: how stiff it is, what it loses, what it rests on."""

from collections import Counter
from collections.abc import Sequence

from jointfmu_fmu_src.native.page import panels

from jointfmu.joints import KINDS

from ..ramps.loops import HysteresisLoops
from ..shown import Stated, quantity
from .course import Course

_STIFFNESS = ("N/m", "N.m/rad")
_ALIKE = 0.02
"""Share [1] by which a stiffness may change and still be called constant."""


def opening(course: Course, loops: HysteresisLoops | None, numbers: Sequence[Stated]) -> str:
    """A few sentences; `loops` of a joint with memory, `numbers` of its file."""
    lines = [f"A {KINDS[course.file.joint].title}.", _stiff(course)]
    if loops:
        lines.append(_lost(loops))
    count = Counter(one.kind for one in numbers)
    weak = [f"{count[kind]} {told}" for kind, told in _WEAK.items() if count[kind]]
    if weak:
        total = sum(count.values())
        lines.append(
            f"Of the {total} numbers behind it {' and '.join(weak)}; each is listed below with its source."
        )
    return " ".join(line for line in lines if line)


_WEAK = {"estimate": "are estimates", "calibration": "were fitted"}


def _told(value: float, unit: str) -> str:
    text, shown = quantity(value, unit, 3)
    return f"{float(text):.6g} {shown}"


def _stiff(course: Course) -> str:
    """The stiffness over the load ramp; empty if no curve shows one."""
    units = {v.name: v.unit for v in (*course.model.inputs, *course.model.outputs)}
    shown = [
        (over, name) for over, names in panels(course.model) for name in names if units[name] in _STIFFNESS
    ]
    if not shown:
        return ""
    over, name = shown[0]
    columns = course.ramp()
    first, last = (float(columns[name][i]) for i in (0, -1))
    end = f"{over} = {_told(float(columns[over][-1]), units[over])}"
    if abs(last - first) <= _ALIKE * abs(last):
        return f"Its stiffness {name} is {_told(last, units[name])}, nearly constant up to {end}."
    start = _told(first, units[name]) if first > 0.0 else "nothing"
    word = "grows" if last > first else "falls"
    times = f", {max(first, last) / min(first, last):.2g} times" if min(first, last) > 0.0 else ""
    begin = f"{over} = {_told(float(columns[over][0]), units[over])}"
    return (
        f"Its stiffness {name} {word} from {start} at {begin} to "
        f"{_told(last, units[name])} at {end}{times}: a constant spring is right at one load only."
    )


def _lost(loops: HysteresisLoops) -> str:
    """What the largest loop loses."""
    row = max(loops.rows(), key=lambda row: row["motion"])
    if not row["loss"]:
        return "Moved to and fro it comes back on the same curve: it has no hysteresis."
    amplitude = f"{loops.motion} = {_told(row['motion'], loops.units[0])}"
    return (
        f"Moved to and fro between plus and minus {amplitude} it turns {_told(row['loss'], 'J')} into heat "
        f"in each cycle, a loss factor of {row['loss_factor']:.2g}."
    )
