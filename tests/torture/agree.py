#!/usr/bin/env python3
"""Runs random mechanisms by methods that share no steps, and compares their motions.

Motors, limits, friction, springs, dampers and loads on the coordinates of arms of one to three rods, many of them
functions of time. Two runs that both end without a warning must agree. Without arguments: 40 mechanisms in seconds.
The exit status is 0 if all agree, 1 if some do not, 2 if a run does not end as runs do."""
import argparse
import csv
import pathlib
import random
import subprocess
import sys
import tempfile

METHODS = {"by default": [], "dop853": ["--integrator", "dop853", "--local-error", "1e-9"],
           "radau5": ["--integrator", "radau5", "--local-error", "1e-8"],
           "rk4": ["--integrator", "rk4", "--step", "0.0005"]}
DURATION, ROWS = 1.5, 30
AGREE = 3e-4  # [m, rad]: three times the accuracy by default


def wave(draw, size, unit, about=0.0):
    shape = f"{size:.3g} [{unit}] * {draw.choice(['sin', 'cos'])}({draw.choice([1, 2, 3, 5, 7])}*time / 1 [s])"
    return f'"{about:.3g} [{unit}] + {shape}"' if about else f'"{shape}"'


def effects(draw, coordinate):
    """Lines of the scene, each with a chance of its own. A coordinate that is an angle has radians, a slide metres."""
    unit, force = ("rad", "N*m") if coordinate == "angle" else ("m", "N")
    lines = []
    if draw.random() < 0.6:
        steady = f"{draw.uniform(-3, 3):.3g}"
        speed = draw.choice([steady, wave(draw, draw.uniform(0.5, 3), unit + "/s")])
        most = draw.choice(["", f", max = {draw.choice([1, 3, 10, 30])}"])
        lines.append(f"motor = {{ speed = {speed}{most} }}")
    if draw.random() < 0.7:
        lower, upper = draw.uniform(-0.6, -0.1), draw.uniform(0.1, 0.6)
        moves = draw.random() < 0.25
        end = wave(draw, 0.15, unit, upper + 0.2) if moves else f"{upper:.3g}"
        lines.append(f"limit = {{ lower = {lower:.3g}, upper = {end} }}")
    if draw.random() < 0.35:
        lines.append(f"friction = {draw.choice([0.2, 1, 4])}")
    if draw.random() < 0.25:
        lines.append(f"spring = {{ stiffness = {draw.choice([5, 50, 500])}, damping = {draw.choice([0, 0.5, 5])} }}")
    if draw.random() < 0.2:
        lines.append(f"damper = {draw.choice([0.3, 3])}")
    if draw.random() < 0.2:
        lines.append(f"load = {wave(draw, draw.uniform(1, 8), force)}")
    draw.shuffle(lines)
    return [f"{coordinate}.{line}" for line in lines]


def scene(seed):
    draw = random.Random(seed)
    lines = [f'title = "agree {seed}"', f"gravity = [0, {draw.choice([0, -9.81, -9.81])}]", f"duration = {DURATION}"]
    rods = draw.choice([1, 1, 2, 2, 3])
    for k in range(rods):
        lines += ["[[body]]", f'name = "rod{k}"', f"mass = {draw.choice([0.5, 1, 2, 5])}", "shape = { rod = 1 }",
                  f"position = [{k + 0.5}, 0]"]
    for k in range(rods):
        slides = k == 0 and draw.random() < 0.2
        bodies = '["world", "rod0"]' if k == 0 else f'["rod{k - 1}", "rod{k}"]'
        lines += ["[[joint]]", f'name = "joint{k}"', f'type = "{"prismatic" if slides else "revolute"}"',
                  f"bodies = {bodies}", f"at = [{k}, 0]", *effects(draw, "slide" if slides else "angle")]
    return "\n".join(lines) + "\n"


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
    columns = [k for k, name in enumerate(head) if name.endswith((".x", ".y", ".angle"))]
    return [[float(row[k]) for k in columns] for row in rows]


def farthest(some, others):
    apart = [max(abs(a - b) for a, b in zip(x, y)) for x, y in zip(some, others)]
    worst = max(range(len(apart)), key=apart.__getitem__)
    first = next((k for k, far in enumerate(apart) if far > AGREE), worst)
    return apart[worst], DURATION * (first + 1) / ROWS


def judge(run, seed, folder):
    """The differences, in words; and how many runs told that they are not to be trusted."""
    (folder / "scene.toml").write_text(scene(seed), encoding="utf-8")
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cdot_run", help="the program cdot-run")
    parser.add_argument("--seed", type=int, default=0, help="of the first mechanism")
    parser.add_argument("--count", type=int, default=40, help="of mechanisms")
    parser.add_argument("--print", action="store_true", help="print the scene of the first seed, and run nothing")
    given = parser.parse_args()
    if given.print:
        print(scene(given.seed), end="")
        return 0
    differ = told = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(given.seed, given.seed + given.count):
            try:
                faults, doubtful = judge(given.cdot_run, seed, pathlib.Path(folder))
            except (RuntimeError, subprocess.TimeoutExpired) as fault:
                print(f"seed {seed}: {fault}")
                return 2
            told += doubtful
            differ += bool(faults)
            for fault in faults:
                print(f"seed {seed}: {fault}. See it: {sys.argv[0]} --print --seed {seed} {given.cdot_run}")
    print(f"{given.count} mechanisms by {len(METHODS)} methods: {differ} differ, {told} runs warned or failed")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
