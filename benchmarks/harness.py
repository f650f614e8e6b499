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


def time_fastest_call(
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
    result, seconds = time_fastest_call(call, 1, process_time)
    print(f"{name}: {seconds:.2f} s", flush=True)
    return result


def judge_target(value: float, limit: float) -> str:
    """Text: whether a value meets its target."""
    return "met" if value <= limit else "MISSED"


def read_options(description: str | None, **options: Mapping[str, object]) -> argparse.Namespace:
    """Parse the command line: `--quick`, and options given as {name: keywords of add_argument}."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="measure with few repetitions: faster, but the times are inaccurate",
    )
    for name, keywords in options.items():
        parser.add_argument("--" + name.replace("_", "-"), **keywords)  # type: ignore[arg-type]
    return parser.parse_args()


def require_machine(available: bool, requirement: str) -> None:
    """End the script with one line if the machine lacks a requirement."""
    if not available:
        raise SystemExit(f"this machine is {sys.platform}; required: {requirement}")
