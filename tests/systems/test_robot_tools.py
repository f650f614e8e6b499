"""Pages on robot simulators: their commands and code run (Drake and Pinocchio if installed), with the results
of `robot`.
"""

import json
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

import pytest
from clients import needs
from conftest import here_alone
from jointfmu_tools import cli

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "page", [pytest.param("drake", marks=needs("Drake")), pytest.param("pinocchio", marks=needs("Pinocchio"))]
)
def test_the_page_gives_wind_up_and_tip_error(page, capsys, tmp_path, enter):
    """The code of the page prints wind-up and tip error by the law of the drives, as the command does."""
    enter(chdir(ROOT))
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / f"docs/tools/{page}.md").read_text(), re.DOTALL)
    exec(compile(code, page, "exec"), {})
    said = capsys.readouterr().out
    *wound, moved = map(float, re.findall(r"\d+\.\d*", said))
    words = "--drive joint2=CSG-40-100 joint3=CSG-25-100 --payload 3 --pose joint2=0.7 joint3=0.8 --json"
    assert cli.main(["robot", "models/robots/six_axis.xml", *words.split(), "--out", str(tmp_path)]) == 0
    expected = json.loads(capsys.readouterr().out)
    assert 1e-3 * moved == pytest.approx(expected["tip_error"], rel=2e-3)
    for angle, name in zip(wound[1:3], ("joint2", "joint3"), strict=True):
        assert 1e-3 * angle == pytest.approx(expected["wind_up"][name], rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "found"),
    [("mujoco", r"elbow at (29\.\d|30\.\d)\d\d deg, -?\d\.\d\d N m"), ("ros2", r"wrote \S*drive\.urdf")],
)
def test_what_the_page_has_runs_top_to_bottom(page, found, capsys, tmp_path, enter):
    """All code of the page runs, except installations."""
    shutil.copytree(ROOT / "models/robots", tmp_path / "models/robots")
    enter(chdir(tmp_path))
    text = (ROOT / f"docs/tools/{page}.md").read_text()
    said = []
    with here_alone():
        for language, block in re.findall(r"```(sh|python)\n(.*?)```", text, re.DOTALL):
            if language == "python":
                # a process of its own: MuJoCo loads a plugin once
                own = [sys.executable, "-c", block]
                run = subprocess.run(own, capture_output=True, text=True, check=True)
                said.append(run.stdout)
                continue
            for line in block.splitlines():
                command, *words = shlex.split(line, comments=True)
                assert command in ("jointfmu", "python")
                assert command == "python" or cli.main(words) == 0
    assert re.search(found, "".join(said) + capsys.readouterr().out)
