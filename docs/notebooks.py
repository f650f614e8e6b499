"""Examples as notebooks with their output, and as pages of the site."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import jupytext
import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbconvert import MarkdownExporter
from nbformat import NotebookNode

EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))
"""Scripts with cells in the percent format, whose first cell is text."""
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}
KERNEL_ENVIRONMENT = {
    "MPLBACKEND": "module://matplotlib_inline.backend_inline",
    "JOINTFMU_STATUS_DELAY": "inf",  # the lines that name the present step of a command are no result
}


def read_notebook(script: Path) -> NotebookNode:
    """Read a script as a notebook without output."""
    notebook = jupytext.read(script, fmt="py:percent")
    notebook.metadata = {"kernelspec": KERNEL}
    for number, cell in enumerate(notebook.cells):
        cell.id = f"cell-{number}"
    return notebook


def run_notebook(notebook: NotebookNode, folder: Path) -> None:
    """Run a notebook in a folder, and store the output in the notebook.

    Raises CellExecutionError if a cell fails.
    """
    client = NotebookClient(
        notebook,
        timeout=1800,  # of one cell [s]
        startup_timeout=300,
        coalesce_streams=True,
        extra_arguments=["--log-level=ERROR"],
        resources={"metadata": {"path": str(folder)}},
    )
    # standard output of the kernel repeats what the notebook stores
    client.execute(env=os.environ | KERNEL_ENVIRONMENT, stdout=subprocess.DEVNULL)
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # times of day


def write_page(script: Path, pages: Path, finished: Path | None) -> None:
    """Write the page, the figures, the notebook and the script of an example into a folder.

    finished : folder that may hold the notebook with its output; otherwise the example is run. If it fails,
        the page states the error, and has no output.
    """
    name = f"{script.stem}.ipynb"
    note = ""
    if finished and (finished / name).is_file():
        notebook = nbformat.read(finished / name, as_version=4)
    else:
        notebook = read_notebook(script)
        print(f"run {script.name}", flush=True)
        with TemporaryDirectory() as folder:
            try:
                run_notebook(notebook, Path(folder))
            except CellExecutionError as error:
                note = f"*Without output, because the script failed on this machine: {error.evalue}*\n\n"
                print(f"{script.name}: {error.ename}: {error.evalue}", file=sys.stderr)
                notebook = read_notebook(script)
    text, resources = MarkdownExporter().from_notebook_node(
        notebook, {"unique_key": script.stem, "output_files_dir": f"{script.stem}_files"}
    )
    for path, data in resources["outputs"].items():
        (pages / path).parent.mkdir(exist_ok=True)
        (pages / path).write_bytes(data)
    title, _, rest = text.partition("\n")
    links = f"Download: [notebook]({name}){{ download }}, [script]({script.name}){{ download }}"
    text = f"{title}\n\n{links}\n\n{note}{rest}".replace("![png](", f"![Figure of {script.name}](")
    (pages / script.name).write_bytes(script.read_bytes())
    (pages / f"{script.stem}.md").write_text(text, encoding="utf-8")
    nbformat.write(notebook, pages / name)
