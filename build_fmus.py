"""Build every FMU, validate it, run the load ramps, compare with the papers, write the report."""

import argparse
import sys
from pathlib import Path

try:
    from jointfmu_tools.cli.pipeline import main
except ImportError as error:
    sys.exit(f"build_fmus.py: {error}; install what building needs with: pip install -e '.[build]'")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=Path("dist"), metavar="DIR", help="folder to write (default: dist)"
    )
    sys.exit(main(parser.parse_args().out))
