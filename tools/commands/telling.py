"""How the commands tell a judgement."""

import sys

from ..judgement import Judgement


def tell(found: Judgement, of: str = "") -> None:
    """Print a judgement: what is found, and the warnings on standard error; `of` is put before."""
    for line in found.lines():
        print(f"{of}{line}")
    for warning in found.warnings:
        print(f"warning: {of}{warning}", file=sys.stderr)
