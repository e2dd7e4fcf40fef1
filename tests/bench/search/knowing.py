#!/usr/bin/env python3
"""The cost of knowing the error of a run: instructions that the estimate and the balance add to those of the rest.

Usage: tests/bench/search/knowing.py CDOT_RUN [INTEGRATOR]     (rattle; needs valgrind, takes some minutes)
       tests/bench/search/knowing.py CDOT_RUN INTEGRATOR STEPS SCENE...     fails if one share is above 5 %

Counts by callgrind, of the whole process that reads, runs and reports a scene, over all scenes of specs/scenes at steps
of 2 ms. The energy itself does not count: it stands in each row of a trajectory.
"""
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


def counted(program, scene, integrator, steps):
    """Instructions of the process, and of each part."""
    with tempfile.NamedTemporaryFile() as profile:
        subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile.name}", program, "simulate", scene,
                        "--integrator", integrator, "--step", str(STEP), "--until", str(steps * STEP)],
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)  # a failed run counts as well
        listing = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", profile.name],
                                 capture_output=True, text=True, check=True).stdout
    whole, parts = 0, dict.fromkeys(PARTS, 0)
    for line in listing.splitlines():
        if not (number := re.match(r"\s*([\d,]+) \(", line)):
            continue
        instructions = int(number[1].replace(",", ""))
        if "PROGRAM TOTALS" in line:
            whole = instructions
        for part, name in PARTS.items():
            if re.search(name, line):
                parts[part] += instructions
    return whole, parts


def share_of(counts):
    whole, parts = counts
    known = sum(parts.values())
    return 100 * known / (whole - known)


def check(program, integrator, steps, scenes):
    shares = {scene: share_of(counted(program, scene, integrator, int(steps))) for scene in scenes}
    for scene, share in shares.items():
        print(f"{integrator}, {steps} steps: {share:5.2f} % in {scene}")
    sys.exit(not all(share <= MOST for share in shares.values()))


def main():
    program, integrator = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "rattle"
    if len(sys.argv) > 4:
        check(program, integrator, sys.argv[3], sys.argv[4:])
    scenes = sorted(str(scene) for scene in Path("specs/scenes").glob("**/*.toml"))
    for steps in COUNTS:
        shares = {part: [] for part in ("all", *PARTS)}
        for scene in scenes:
            whole, parts = counted(program, scene, integrator, steps)
            known = sum(parts.values())
            shares["all"].append((share_of((whole, parts)), scene))
            for part, instructions in parts.items():
                shares[part].append((100 * instructions / (whole - known), scene))
        for part, values in shares.items():
            worst, scene = max(values)
            print(f"{integrator}, {steps} steps: {part:8} {statistics.median(v for v, _ in values):5.1f} % in the median of "
                  f"{len(values)} scenes, {worst:5.1f} % at most ({scene})", flush=True)
        for share, scene in sorted(shares["all"], reverse=True):
            if share > MOST:
                print(f"    {share:4.1f} % in {scene}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main()
