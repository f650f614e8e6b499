"""How long the laboratory takes to redraw when a slider moves, in headless Chromium; and its pictures.

    python benchmarks/laboratory.py [--pictures DIR]

From the slider's event to the end of the frame that shows it, script, layout and painting, for every joint
with its first path; of that the page waits up to 17 ms for the next frame. The first change is left out.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from browser import PROGRAM, browser
from jointfmu_fmu_src.laboratory import write_laboratory

CHANGES = 30
MOVE = """(async () => {
  const lab = await laboratory;
  const names = Object.keys(lab.controls).filter((name) => lab.controls[name].range), times = [];
  for (let i = 0; i <= CHANGES; i++) {
    const range = lab.controls[names[i % names.length]].range, began = performance.now();
    range.value = Number(range.value) + (i % 2 ? 7 : -7);
    range.dispatchEvent(new Event("input"));
    await new Promise((done) => requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = done;
      channel.port2.postMessage(0);
    }));
    document.body.getBoundingClientRect();
    times.push([performance.now() - began, lab.took]);
  }
  return times.slice(1);
})()"""


def main(pictures: Path | None) -> None:
    """Print the times of every joint."""
    if PROGRAM is None:
        sys.exit("no Chromium is installed; Debian's package is chromium")
    with tempfile.TemporaryDirectory() as folder, browser() as shown:
        page = Path(folder) / "laboratory.html"
        write_laboratory(page)
        shown.shape(1400, 1000)
        shown.open(page)
        models = shown.run(
            "laboratory.then((lab) => [...document.getElementById('model').options].map((o) => o.value))"
        )
        print(f"page: {page.stat().st_size / 1e3:.0f} kB\n")
        print(f"{'model':26}{'median':>8}{'most':>8}{'script':>8}  [ms] over {CHANGES} changes")
        for model in models:
            shown.run(f"laboratory.then((lab) => lab.choose('{model}', 0))")
            frame, script = np.array(shown.run(MOVE.replace("CHANGES", str(CHANGES)))).T
            print(f"{model:26}{np.median(frame):8.1f}{frame.max():8.1f}{np.median(script):8.1f}")
            if pictures:
                pictures.mkdir(parents=True, exist_ok=True)
                for dark in (False, True):
                    for name, width, phone in (("desktop", 1400, False), ("phone", 390, True)):
                        shown.shape(width, 900, dark, phone)
                        shown.run("new Promise((done) => setTimeout(done, 300))")
                        shown.picture(pictures / f"{model}_{name}_{'dark' if dark else 'light'}.png")
                shown.shape(1400, 1000)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="write PNG files of every joint there")
    main(parser.parse_args().pictures)
