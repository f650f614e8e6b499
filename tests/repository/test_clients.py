"""Clients, which only some machines have: one table lists them, and only clients make a test skip."""

import ast
import os
import re
from collections.abc import Iterator
from pathlib import Path

import clients
import pytest
from clients import CLIENTS, Client, skip_reason, skip_without
from conftest import RUN

TESTS = Path(__file__).resolve().parents[1]
CONTRIBUTING = (TESTS.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
SKIPPING = {"skip", "skipif", "importorskip", "xfail"}
"""Names of pytest that let a test pass without a result."""


def table() -> dict[str, tuple[str, str, int]]:
    """Rows of the table in CONTRIBUTING.md: {client: (what it proves, how to install it, tests)}."""
    section = CONTRIBUTING.partition("## What only some machines prove")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| (.+) \| (.+) \| (\d+) \|$", section, re.MULTILINE)
    return {name: (proves, install, int(count)) for name, proves, install, count in rows}


def test_the_table_lists_all_clients():
    rows = table()
    assert list(rows) == list(CLIENTS)
    for name, client in CLIENTS.items():
        assert rows[name][:2] == (client.proves, client.install)


def test_the_table_counts_the_tests_that_need_a_client(request: pytest.FixtureRequest):
    """All tests are counted if all files were collected; otherwise the table has at least as many."""
    counts = {name: count for name, (*_, count) in table().items()}
    collected = {item.path for item in request.session.items}
    if collected >= set(TESTS.rglob("test_*.py")):
        assert dict(clients.COUNTS) == counts
    else:
        assert all(clients.COUNTS[name] <= count for name, count in counts.items())


def test_only_clients_make_a_test_skip():
    """No other test file uses the names that skip a test."""
    found = {
        f"{path.relative_to(TESTS)}:{node.lineno} {node.attr}"
        for path in TESTS.rglob("*.py")
        if path.name not in ("clients.py", "test_clients.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute)
        and node.attr in SKIPPING
        and ast.unparse(node).startswith("pytest.")
    }
    assert found == set()


@pytest.fixture
def own_results(tmp_path: Path) -> Iterator[None]:
    """Results of the probes in a folder of the test; its clients are removed after it."""
    names = {*CLIENTS}
    clients.share_results(tmp_path)
    yield
    clients.share_results(Path(os.environ[RUN]))
    clients.unusable.cache_clear()
    for name in {*CLIENTS} - names:
        del CLIENTS[name]


def test_a_client_that_fails_skips_with_what_to_install(own_results):
    """The probe runs once, even if another process asks: the first result is in a file."""
    calls = []

    def probe() -> None:
        calls.append(None)
        raise OSError("libmissing.so: cannot open shared object file")

    CLIENTS["missing"] = Client(probe, "nothing", "`libmissing`")
    reason = "needs missing; install: `libmissing` (libmissing.so: cannot open shared object file)"
    for _ in range(2):
        clients.unusable.cache_clear()  # as a new process
        assert skip_reason("missing") == reason
    assert len(calls) == 1
    with pytest.raises(pytest.skip.Exception, match=re.escape(reason)):
        skip_without("Linux or macOS", "missing")


def test_a_client_that_works_skips_nothing(own_results):
    CLIENTS["present"] = Client(lambda: None, "something", "nothing")
    assert skip_reason("present") == ""
    skip_without("present")


def test_an_unknown_client_is_an_error():
    with pytest.raises(pytest.UsageError, match=r"needs\('typo'\): no such client; allowed are ecos, "):
        clients.count_tests(["typo"])


def test_a_script_that_fails_says_why_in_one_line():
    """A script that fails, as with a package whose library cannot be loaded, gives the last line of the
    traceback."""
    with pytest.raises(OSError, match=r"^OSError: libmissing\.so: cannot open shared object file$"):
        clients.script("raise OSError('libmissing.so: cannot open shared object file')")()
