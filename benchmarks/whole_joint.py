"""The whole bolted joint of the README's example by what it is attached at, beside its interface alone.

Run: python benchmarks/whole_joint.py
"""

import argparse
import sys
from collections.abc import Sequence

from jointfmu_tools.joints.bolted_joint.new import NEW

EXAMPLE = {
    "plate": "200x100",
    "bolts": "4xM12",
    "at": ["160x60"],
    "grip": ["40"],
    "material": ["steel"],
    "finish": ["ground"],
    "preload": "30e3",
}
ROWS = ("xx", "yy", "zz", "rx", "ry", "rz")


def facts(attached: str, example: dict[str, object] = EXAMPLE) -> dict[str, tuple[float, str, str]]:
    """What `jointfmu new bolted-joint` prints."""
    given = dict.fromkeys(option.name for option in NEW.options) | example | {"attached": attached}
    return dict(NEW.make_joint(given).facts)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    print("| attached | " + " | ".join(f"K_{row}" for row in ROWS) + " | load factor | interface |")
    print("|---|" + "---|" * (len(ROWS) + 2))
    for attached in ("faces", "edge", "heads"):
        found = {name: value for name, (value, _, _) in facts(attached).items()}
        cells = [f"{found[f'joint_K_{row}']:.3g}" for row in ROWS]
        cells += [f"{found['joint_load_factor']:.3f}", f"{found['interface_share']:.1%}"]
        print(f"| `{attached}` | " + " | ".join(cells) + " |")
    single = EXAMPLE | {"plate": "80x80", "bolts": "M16", "at": None, "preload": "60e3"}
    found = {name: value for name, (value, _, _) in facts("heads", single).items()}
    members = found["joint_K_zz"] - found["bolt_stiffness"]
    print(f"\none M16, heads: members with interface {members:.4g} N/m, ", end="")
    print(f"VDI 2230 {found['member_stiffness']:.4g};")
    print(f"load factor {found['joint_load_factor']:.4f}, VDI 2230 {found['load_factor']:.4f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
