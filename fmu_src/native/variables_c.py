"""variables.c: the list of variables with their intervals, and which output depends on what."""

from jointfmu.joints.model import Model
from jointfmu.quantity import Interval

from ..joint_parts.c_text import array, number, string


def variables_c(model: Model) -> str:
    """The file."""
    rows = [_row("time", "s", "time", Interval())]
    rows += [_row(v.name, v.unit, v.doc, v.interval) for v in model.inputs]
    rows += [_row(v.name, v.unit, v.doc, Interval()) for v in model.outputs]
    for name, item in model.parameter_fields().items():
        meta = item.metadata
        if "allowed" in meta:
            rows.append(_row(name, "1", meta["doc"], Interval.of(ge=0.0, le=1.0), boolean=True))
        else:
            rows.append(_row(name, meta["unit"], meta["doc"], meta["interval"], meta["whole"]))
    states = model.outputs[: model.states]
    links = [
        "{" + ", ".join(str(int(i.name in model.depends(o.name))) for i in (*model.inputs, *states)) + "}"
        for o in model.outputs
    ]
    nominals = array("const double nominals[N_STATES]", [number(v.nominal) for v in states])
    return (
        '#include "variables.h"\n\n#include <math.h>\n\n'
        + array("const Variable variables[N_VALUES]", rows)
        + "\n"
        + array("const unsigned char depends[N_OUTPUTS][N_INPUTS + N_STATES]", links)
        + (nominals if states else "")
    )


def _row(
    name: str,
    unit: str,
    doc: str,
    allowed: Interval,
    whole: bool = False,
    boolean: bool = False,
) -> str:
    flags = ", ".join(str(int(flag)) for flag in (allowed.low_open, allowed.high_open, whole, boolean))
    numbers = ", ".join(number(x) for x in (allowed.low, allowed.high))
    interval = "" if boolean else str(allowed)
    texts = ", ".join(string(x) for x in (name, "" if unit == "1" else unit, doc, interval))
    return f"{{{texts}, {numbers}, {flags}}}"
