#!/usr/bin/env python3
"""The cost of knowing the error of a run: instructions that the estimate and the balance add to those of the rest.

Usage: tests/bench/search/knowing.py CDOT_RUN [INTEGRATOR]     (rattle; needs valgrind, takes some minutes)
       tests/bench/search/knowing.py CDOT_RUN INTEGRATOR STEPS              all scenes at so many steps
       tests/bench/search/knowing.py CDOT_RUN INTEGRATOR STEPS SCENE...     fails if one share is above 5 %

Counts by callgrind, of the whole process that reads, runs and reports a scene, over all scenes of specs/scenes at steps
of 2 ms. The energy itself does not count: it stands in each row of a trajectory. Nor does the search for advice, which
only a run begins that warns or fails: its trials are runs, each with an estimate of its own. Shares with it stand beside.
"""
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

STEP, COUNTS, MOST = 0.002, (5, 20, 60, 200, 1000), 5
# Of these, each with all that it calls. Templates name their callers in their arguments; only what follows `void` counts.
PARTS = {
    "estimate": r"ErrorEstimate<.*>::(ErrorEstimate|before_step|after_step)\(",
    "balance": r"WorstStepWatch<.*>::look\(",
    "booking": r":void cdot::(begin_accounts|begin_kick|note_at_rest|book_kick|book_work|book_stiffness|find_power"
               r"|look_at_effects)<",
}


ADVICE = "cdot::find_advice*"


def counts_in(profile):
    """Instructions in all, and of each part."""
    listing = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", profile], capture_output=True,
                             text=True, check=True).stdout
    counts = dict.fromkeys(("whole", *PARTS), 0)
    for line in listing.splitlines():
        if not (number := re.match(r"\s*([\d,]+) \(", line)):
            continue
        instructions = int(number[1].replace(",", ""))
        if "PROGRAM TOTALS" in line:
            counts["whole"] = instructions
        for part, name in PARTS.items():
            if re.search(name, line):
                counts[part] += instructions
    return counts


def counted(program, scene, integrator, steps):
    """Instructions of the process and of each part: up to a search for advice, and with it."""
    with tempfile.TemporaryDirectory() as folder:
        profile = os.path.join(folder, "profile")
        run = subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={profile}",
                              f"--dump-before={ADVICE}", program, "simulate", scene, "--integrator", integrator,
                              "--step", str(STEP), "--until", str(steps * STEP)],
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        if run.returncode not in (0, 1):  # a run that fails counts as well
            sys.exit(f"{scene} by {integrator}: {run.stderr.strip() or f'exit status {run.returncode}'}")
        last, before = counts_in(profile), profile + ".1"
        first = counts_in(before) if os.path.exists(before) else last
        if not known_in(first):
            sys.exit(f"{scene}: no part of the cost is in its profile: have its functions other names?")
        if first is last:
            return last, last
        return first, {key: first[key] + last[key] for key in first}


def known_in(counts):
    return sum(counts[part] for part in PARTS)


def share_of(counts):
    return 100 * known_in(counts) / (counts["whole"] - known_in(counts))


def in_words(share, with_advice):
    return f"{share:5.2f} %" + (f" ({with_advice:.2f} % with the search for advice)" if with_advice != share else "")


def check(program, integrator, steps, scenes):
    well = True
    for scene in scenes:
        share, with_advice = map(share_of, counted(program, scene, integrator, int(steps)))
        print(f"{integrator}, {steps} steps: {in_words(share, with_advice)} in {scene}", flush=True)
        well = well and share <= MOST
    sys.exit(not well)


def study(program, integrator, steps, scenes):
    counts = {scene: counted(program, scene, integrator, steps) for scene in scenes}
    shares = {scene: [share_of(of) for of in both] for scene, both in counts.items()}
    for part in ("all", *PARTS):
        values = [(share, scene) for scene, (share, _) in shares.items()] if part == "all" else \
            [(100 * run[part] / (run["whole"] - known_in(run)), scene) for scene, (run, _) in counts.items()]
        worst, scene = max(values)
        print(f"{integrator}, {steps} steps: {part:8} {statistics.median(v for v, _ in values):5.1f} % in the median of "
              f"{len(values)} scenes, {worst:5.1f} % at most ({scene})", flush=True)
    for scene, (share, with_advice) in sorted(shares.items(), key=lambda item: -max(item[1])):
        if max(share, with_advice) > MOST:
            print(f"    {in_words(share, with_advice)} in {scene}", flush=True)


def main():
    program, integrator = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "rattle"
    if len(sys.argv) > 4:
        check(program, integrator, sys.argv[3], sys.argv[4:])
    scenes = sorted(str(scene) for scene in Path("specs/scenes").glob("**/*.toml"))
    if not scenes:
        sys.exit("specs/scenes: no scenes here; run it at the top of the tree")
    for steps in [int(sys.argv[3])] if len(sys.argv) > 3 else COUNTS:
        study(program, integrator, steps, scenes)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main()
