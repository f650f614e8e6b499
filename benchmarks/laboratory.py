"""Time that the laboratory page needs to redraw after a slider moves, in headless Chromium; and pictures.

    python benchmarks/laboratory.py [--quick] [--pictures DIR]

The time runs from the event of the slider to the end of the frame that shows the change: script, layout and
painting. The time is measured for every joint with its first path, on a desktop (1400 x 1000) and on a phone
(390 x 800, with a processor that Chromium makes four times slower), with the curves or the path in view. The
changes come at random moments, as from a hand, so work outside the view delays them. The time includes up to
17 ms of waiting for the next frame. The first change is left out.
"""

import argparse
import os
import tempfile
from pathlib import Path

import harness
import numpy as np
from browser import PROGRAM, browser
from jointfmu_tools.pages.laboratory.assemble import write_laboratory

CHANGES = 60
SCREENS = {"desktop": (1400, 1000, False, 1), "phone": (390, 800, True, 4)}
"""Screens {name: (width, height, whether it is a phone, slowdown of the processor)}."""
VIEWS = ("curves", "path")
MOVE = """(async () => {
  const lab = await laboratory;
  document.getElementById(VIEW).scrollIntoView();
  await new Promise((done) => setTimeout(done, 500));
  const names = Object.keys(lab.controls).filter((name) => lab.controls[name].range), times = [];
  for (let i = 0; i <= CHANGES; i++) {
    await new Promise((done) => setTimeout(done, 60 * Math.random()));
    const range = lab.controls[names[i % names.length]].range, began = performance.now();
    range.value = Number(range.value) + (i % 2 ? 7 : -7);
    range.dispatchEvent(new Event("input"));
    await new Promise((done) => requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = done;
      channel.port2.postMessage(0);
    }));
    times.push([performance.now() - began, lab.took]);
  }
  return times.slice(1);
})()"""


def main(options: argparse.Namespace) -> None:
    """Print the times of every joint on the page."""
    harness.require(PROGRAM is not None, "Chromium (Debian: chromium)")
    pictures, changes = options.pictures, 3 if options.quick else CHANGES
    with tempfile.TemporaryDirectory() as folder, browser() as shown:
        page = Path(folder) / "laboratory.html"
        write_laboratory(page)
        shown.open(page)
        models = shown.run(
            "laboratory.then((lab) => [...document.getElementById('model').options].map((o) => o.value))"
        )
        print(f"page: {page.stat().st_size / 1e3:.0f} kB")
        print(f"load: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n")
        print(f"{'model':24}{'screen':>9}{'view':>8}{'median':>8}{'p95':>8}{'most':>8}{'script':>8}  [ms]")
        for model in models:
            for screen, (width, height, phone, slower) in SCREENS.items():
                shown.shape(width, height, phone=phone)
                shown.call("Emulation.setCPUThrottlingRate", rate=slower)
                shown.run(f"laboratory.then((lab) => lab.choose('{model}', 0))")
                for view in VIEWS:
                    script = MOVE.replace("CHANGES", str(changes)).replace("VIEW", f"'{view}'")
                    frame, own = np.array(shown.run(script)).T
                    found = (np.median(frame), np.quantile(frame, 0.95), frame.max(), np.median(own))
                    print(f"{model:24}{screen:>9}{view:>8}" + "".join(f"{t:8.1f}" for t in found), flush=True)
            shown.call("Emulation.setCPUThrottlingRate", rate=1)
            if pictures:
                pictures.mkdir(parents=True, exist_ok=True)
                for dark in (False, True):
                    for name, width, phone in (("desktop", 1400, False), ("phone", 390, True)):
                        shown.shape(width, 900, dark, phone)
                        shown.run("new Promise((done) => setTimeout(done, 300))")
                        shown.picture(pictures / f"{model}_{name}_{'dark' if dark else 'light'}.png")


if __name__ == "__main__":
    main(
        harness.read_options(
            __doc__,
            pictures={
                "type": Path,
                "metavar": "DIR",
                "help": "folder to write pictures of all joints to (.png)",
            },
        )
    )
