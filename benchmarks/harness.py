"""Shared parts of the benchmarks: times of calls, verdicts on targets, and the command line.

A benchmark measures the product and the obvious way to do the same in one run, and prints both with their
ratio. No test checks the times. `--quick` runs a benchmark with few repetitions, to show that it works.

This module puts `tests/support` on the import path (cases of the joints, headless browser): import it first.
"""

import argparse
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter, process_time
from typing import TypeVar

ROOT = Path(__file__).resolve().parent.parent
sys.path[1:1] = [str(ROOT / "tests"), str(ROOT / "tests" / "support")]
Result = TypeVar("Result")


def fastest(
    call: Callable[[], Result], repeats: int = 3, clock: Callable[[], float] = perf_counter
) -> tuple[Result, float]:
    """Result of a call, and the shortest time [s] of some repetitions."""
    times = []
    for _ in range(repeats):
        start = clock()
        result = call()
        times.append(clock() - start)
    return result, min(times)


def print_processor_time(name: str, call: Callable[[], Result]) -> Result:
    """Execute a call once, and print the processor time."""
    result, seconds = fastest(call, 1, process_time)
    print(f"{name}: {seconds:.2f} s", flush=True)
    return result


def verdict(value: float, limit: float) -> str:
    """Text: whether a value meets its target."""
    return "met" if value <= limit else "MISSED"


def read_options(description: str | None, **options: Mapping[str, object]) -> argparse.Namespace:
    """Parse the command line: `--quick`, and options given as {name: keywords of add_argument}."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="few repetitions: the times mean little")
    for name, keywords in options.items():
        parser.add_argument("--" + name.replace("_", "-"), **keywords)  # type: ignore[arg-type]
    return parser.parse_args()


def require(available: bool, requirement: str) -> None:
    """End the script with one line if the machine lacks a requirement."""
    if not available:
        raise SystemExit(f"this machine is {sys.platform}; required: {requirement}")
