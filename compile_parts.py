"""Compile the models that a wheel contains, so that users need no compiler; then run `pip wheel .`."""

import argparse
import sys
from pathlib import Path

try:
    from jointfmu_fmu_src.native.compiled.compile_ahead import compile_ahead
    from jointfmu_fmu_src.native.compiled.compiled_models import SHIPPED_MODEL_FOLDER
except ImportError as error:
    sys.exit(f"compile_parts.py: {error}; install what building needs with: pip install -e '.[build]'")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="FMUs (default: all)")
    parser.add_argument(
        "--out", type=Path, default=SHIPPED_MODEL_FOLDER, metavar="DIR", help="default: in the package"
    )
    arguments = parser.parse_args()
    try:
        files = compile_ahead(arguments.names, arguments.out)
    except (ImportError, RuntimeError, ValueError) as error:
        sys.exit(f"compile_parts.py: {error}")
    size = sum(file.stat().st_size for file in files)
    print(f"{len(files)} files, {size / 1e6:.1f} MB in {arguments.out}")
