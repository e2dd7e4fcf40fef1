#!/usr/bin/env python3
"""Runs random arms and loops (arms.py) by methods that share no steps, and compares their motions.

Two runs that both end without a warning must agree. Without arguments: 40 arms of each kind, in seconds. The exit
status is 0 if all agree, 1 if some do not, 2 if a run does not end as runs do."""
import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile

from arms import DURATION, KINDS, scene

METHODS = {"by default": [], "dop853": ["--integrator", "dop853", "--local-error", "1e-9"],
           "radau5": ["--integrator", "radau5", "--local-error", "1e-8"],
           "rk4": ["--integrator", "rk4", "--step", "0.0005"]}
ROWS = 30
PLACES = ("x", "y", "z", "angle", "e0", "e1", "e2", "e3")
AGREE = 3e-4  # [m, rad]: three times the accuracy by default


def places(run, options, folder):
    """Of the bodies at the times of the rows; None if the run tells that it is not to be trusted."""
    times = ",".join(f"{DURATION * (k + 1) / ROWS:.3f}" for k in range(ROWS))
    table = folder / "motion.csv"
    ended = subprocess.run([run, "simulate", folder / "scene.toml", "--times", times, "-o", table, *options],
                           capture_output=True, text=True, timeout=120, check=False)
    if ended.returncode not in (0, 1):
        raise RuntimeError(f"exit status {ended.returncode}: {ended.stderr.strip()}")
    if ended.returncode or "warning" in ended.stdout + ended.stderr:
        return None
    with open(table, encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    columns = [k for k, name in enumerate(head) if name.split(".")[-1] in PLACES]
    return [[float(row[k]) for k in columns] for row in rows]


def farthest(some, others):
    apart = [max(abs(a - b) for a, b in zip(x, y)) for x, y in zip(some, others)]
    worst = max(range(len(apart)), key=apart.__getitem__)
    first = next((k for k, far in enumerate(apart) if far > AGREE), worst)
    return apart[worst], DURATION * (first + 1) / ROWS


def judge(run, kind, seed, folder):
    """The differences, in words; and how many runs told that they are not to be trusted."""
    (folder / "scene.toml").write_text(scene(kind, seed), encoding="utf-8")
    motions = {name: places(run, options, folder) for name, options in METHODS.items()}
    sound = {name: motion for name, motion in motions.items() if motion is not None}
    told = len(motions) - len(sound)
    faults = []
    for name, motion in sound.items():
        if name == "dop853" or "dop853" not in sound:
            continue
        far, since = farthest(motion, sound["dop853"])
        if not far <= AGREE:
            faults.append(f"{name} and dop853 differ by {far:.2g} m or rad, from {since:.2f} s on")
    return faults, told


def compare(run, kind, seeds):
    """How many arms differ, and how many runs tell that they are not to be trusted. Prints the differences."""
    differ = told = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            try:
                faults, doubtful = judge(run, kind, seed, pathlib.Path(folder))
            except (RuntimeError, subprocess.TimeoutExpired) as fault:
                raise RuntimeError(f"{kind}, seed {seed}: {fault}") from fault
            told += doubtful
            differ += bool(faults)
            for fault in faults:
                print(f"{kind}, seed {seed}: {fault}. See it: {sys.argv[0]} --print --kind {kind} --seed {seed} {run}")
    print(f"{kind}: {len(seeds)} arms by {len(METHODS)} methods: {differ} differ, {told} runs warned or failed")
    return differ


def save(kinds, seeds, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for kind in kinds:
        for seed in seeds:
            (folder / f"{kind}_{seed}.toml").write_text(scene(kind, seed), encoding="utf-8")
    print(f"{len(kinds) * len(seeds)} scenes are in {folder}")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cdot_run", help="the program cdot-run")
    parser.add_argument("--kind", choices=KINDS, help="of the arms (see arms.py); all kinds by default")
    parser.add_argument("--seed", type=int, default=0, help="of the first arm")
    parser.add_argument("--count", type=int, default=40, help="of arms of each kind")
    parser.add_argument("--print", action="store_true", help="print the scene of the first seed, and run nothing")
    parser.add_argument("--save", type=pathlib.Path, metavar="FOLDER", help="write the scenes to it, and run nothing")
    given = parser.parse_args()
    kinds = [given.kind] if given.kind else KINDS
    seeds = range(given.seed, given.seed + given.count)
    if given.print:
        print(scene(kinds[0], given.seed), end="")
        return 0
    if given.save:
        return save(kinds, seeds, given.save)
    try:
        differ = [compare(given.cdot_run, kind, seeds) for kind in kinds]
    except RuntimeError as fault:
        print(fault)
        return 2
    return 1 if any(differ) else 0


if __name__ == "__main__":
    sys.exit(main())
