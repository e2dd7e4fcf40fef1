"""Does what the READMEs say, in a copy of the tree: every fenced block is run, or found where the text says that it
stands. usage: claims.py CDOT CDOT_RUN SOURCE"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

cdot, cdot_run, source = (Path(argument).resolve() for argument in sys.argv[1:4])
failures = []


def claim(holds, what):
    print(("holds: " if holds else "FAILS: ") + what)
    if not holds:
        failures.append(what)


def run(command):
    done = subprocess.run(command, shell=True, cwd=place, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def blocks(readme):
    """(the paragraph before, the language, the lines) of every fenced block."""
    lines, before, found = (source / readme).read_text().split("\n"), [], []
    at = 0
    while at < len(lines):
        if lines[at].startswith("```"):
            end = lines.index("```", at + 1)
            paragraph = "\n".join(before).strip().split("\n\n")[-1]
            found.append((paragraph, lines[at][3:], lines[at + 1:end]))
            before, at = [], end
        else:
            before.append(lines[at])
        at += 1
    return found


def occur(lines, text):
    """Every line, in order, with … for anything; but for the space between words."""
    text, start = " ".join(text.split()), 0
    for line in filter(None, (" ".join(line.split()) for line in lines)):
        match = re.compile(".*?".join(map(re.escape, line.split("…")))).search(text, start)
        if not match:
            return line
        start = match.end()
    return None


def links(readme):
    for target in re.findall(r"\]\(([^)#:]+)\)", (source / readme).read_text()):
        claim(((source / readme).parent / target).exists(), f"{readme} links to {target}")


def front_page():
    kinds = set()
    for before, language, lines in blocks("README.md"):
        first = lines[0]
        commands = re.findall(r"`(cdot \w+ [\w/.]+(?: --\w+(?: \w+)?)*)`", before)
        files = re.findall(r"\]\(((?:specs|generated|tests)/[^)]+)\)", before)
        if language == "cmake":
            kind = "cmake"  # tests/install does what it says
        elif language == "python":
            kind = "python"  # tests/derive/python runs it
        elif first.startswith("./"):
            kind = "programs"
            for line in lines:
                claim(os.access(source / line.split()[0], os.X_OK), f"{line.split()[0]} can be run")
        elif "→" in first:
            kind = "stages"
        elif commands and not language:
            kind = "commands"
            if commands[-1].endswith(" --bill"):  # bytes of code and instructions are the compiler's
                lines = [re.sub(r"( +-?\d+){2}$", " …", line) for line in lines]
            missing = occur(lines, run(commands[-1])[1])
            claim(missing is None, f"`{commands[-1]}` prints what is shown" + (f", but for: {missing}" if missing else ""))
        elif files:
            kind = "files"
            missing = occur(lines, (source / files[-1]).read_text())
            claim(missing is None, f"{files[-1]} reads as shown" + (f", but for: {missing}" if missing else ""))
        else:
            kind = "unknown"
            claim(False, "README.md has a block that nothing checks: " + first)
        kinds.add(kind)
    claim(kinds == {"cmake", "python", "programs", "stages", "commands", "files"}, "README.md has blocks of every kind")
    for row in re.findall(r"^\| [\w, ]+ \| (`.*?`) \|", (source / "README.md").read_text(), re.M):
        for name in re.findall(r"`(.*?)`", row):
            name = name if "/" in name else "derive/" + name
            claim(any(source.glob(name)), f"{name} exists")


def kernel_loop():
    """Its code is that of the example."""
    example = (source / "tests/examples/engine.cpp").read_text()
    for _, _, lines in blocks("runtime/include/cdot/kernel.md"):
        missing = occur(lines, example)
        claim(missing is None, "kernel.md shows the example's " + lines[0] + (f", but for: {missing}" if missing else ""))


def verdicts():
    """The count of published formulas by verdict."""
    text = " ".join((source / "README.md").read_text().split())
    counts = re.search(r"compares (\d+) published formulas .*?: (\d+) agree, (\d+) agree under a stated condition, "
                       r"(\d+) differ, and (\d+) are listed", text)
    last = run("cdot diff")[1].strip().split("\n")[-1]
    now = re.findall(r"\d+", last)
    claim(counts is not None and list(counts.groups()[1:]) == now and int(counts.group(1)) == sum(map(int, now)),
          "README.md counts the verdicts: " + last)


def pictures():
    """Each is what its scene, the last one linked before it, looks like now."""
    number = re.compile(r"-?\d+(?:\.\d+)?")
    text = (source / "README.md").read_text()
    for match in re.finditer(r"!\[[^]]*\]\((\.readme/[^)]+)\)", text):
        scene = re.findall(r"\]\((specs/scenes/[^)]+\.toml)\)", text[:match.start()])[-1]
        status, said = run(f"cdot-run simulate {scene} --svg now.svg")
        kept, now = (source / match.group(1)).read_text(), (place / "now.svg").read_text()
        alike = number.sub("#", kept) == number.sub("#", now)
        # Machines may differ in the last digits.
        apart = max((abs(float(a) - float(b)) for a, b in zip(number.findall(kept), number.findall(now))), default=1)
        claim(status == 0 and alike and apart < 1, f"{match.group(1)} is a picture of {scene}")


def teaching_message():
    """The answer to the prismatic Jacobian without the term from the turning axis."""
    hand = place / "specs/planar/prismatic.hand"
    kept = hand.read_text()
    hand.write_text('entry OWN-1 "J without the turning axis"\n  source "me"\n  assume t on b\n'
                    "  J = [ t', cross(ra, t), -t', -cross(rb, t) ; 0, 1, 0, -1 ]\n")
    said = run("cdot diff prismatic")[1]
    shown = re.search(r"answers:\s+\*(.*?)\*", (source / "README.md").read_text(), re.S).group(1)
    claim(occur([shown.strip(" .")], said) is None, "cdot diff teaches: " + " ".join(shown.split()))
    # The example of specs/README.md agrees.
    example = next(lines for _, _, lines in blocks("specs/README.md") if lines[0].startswith("entry "))
    hand.write_text("\n".join(example) + "\n")
    status, said = run("cdot diff prismatic")
    claim(status == 0 and "agrees" in said, "the hand derivation of specs/README.md agrees")
    hand.write_text(kept)


def own_joint():
    """specs/README.md, "Your own joint in two minutes", step by step."""
    lines = next(lines for _, _, lines in blocks("specs/README.md") if lines[0].startswith("joint "))
    name = lines[0].split()[1]
    (place / f"specs/planar/{name}.joint").write_text("\n".join(lines) + "\n")
    kernel = place / f"generated/planar/{name}.hpp"
    kernel.unlink(missing_ok=True)
    steps = re.findall(r"^\d\. .*?`(cdot [^`]+)`", (source / "specs/README.md").read_text(), re.M)
    claim(len(steps) >= 3, "specs/README.md tells at least three commands")
    for step in steps:
        status, said = run(step)
        well = status == 0 or (status == 1 and step.startswith("cdot diff"))  # 1: it found mistakes
        claim(well, f"`{step}` goes well" + ("" if well else ": " + said))
    claim(kernel.exists(), f"cdot derive wrote generated/planar/{name}.hpp")
    (place / "own.cpp").write_text("#include <cdot/planar/registry.hpp>\n")
    (place / "include").mkdir()
    (place / "include/cdot").symlink_to(place / "generated")
    status, said = run("c++ -std=c++20 -fsyntax-only -Wall -Wextra -Werror -I include -I runtime/include own.cpp")
    claim(status == 0, "the kernels compile " + said)


def scenes():
    toml = [lines for _, language, lines in blocks("specs/scenes/README.md") if language == "toml"]
    head = toml[0][:next(k for k, line in enumerate(toml[0]) if line.startswith("[["))]
    for k, lines in enumerate(toml):
        whole = lines if lines[0].startswith("title") else head + lines
        (place / f"scene{k}.toml").write_text("\n".join(whole) + "\n")
        status, said = run(f"cdot-run simulate scene{k}.toml --until 0.25")
        claim(status == 0, f"scene {k + 1} of specs/scenes/README.md runs" + ("" if status == 0 else ": " + said))


def scene_keys():
    """Every key that a scene may have is explained in specs/scenes/README.md."""
    page = (source / "specs/scenes/README.md").read_text()
    keys = re.findall(r"^    (\S+)", run("cdot-run list --keys")[1], re.M)
    claim(len(keys) > 50, f"cdot-run list --keys shows {len(keys)} keys")
    for key in keys:
        claim(re.search(rf"`(angle\.)?{key}\b", page), f"specs/scenes/README.md explains `{key}`")


def scene_commands():
    """Every command of specs/scenes/README.md goes well."""
    for _, language, lines in blocks("specs/scenes/README.md"):
        for line in lines if language == "sh" else []:
            status, said = run(line)
            claim(status == 0, f"`{line}` goes well" + ("" if status == 0 else ": " + said))


def scripts():
    """Each script that a page of tests/ names by its path can be run."""
    named = 0
    for page in sorted(source.glob("tests/**/README.md")):
        for _, _, lines in blocks(page.relative_to(source)):
            for path in (line.split()[0] for line in lines if line.startswith("tests/")):
                named += 1
                claim(os.access(source / path, os.X_OK), f"{path} of {page.relative_to(source)} can be run")
    claim(named > 3, f"{named} scripts are named in pages of tests/")


with tempfile.TemporaryDirectory() as folder:
    place = Path(folder) / "tree"
    place.mkdir()
    for part in ("specs", "generated", "runtime"):
        shutil.copytree(source / part, place / part)
    os.environ["PATH"] = f"{folder}:" + os.environ["PATH"]
    (Path(folder) / "cdot").symlink_to(cdot)
    (Path(folder) / "cdot-run").symlink_to(cdot_run)
    for page in ("README.md", "specs/README.md", "specs/scenes/README.md", "runtime/include/cdot/kernel.md"):
        links(page)
    front_page()
    kernel_loop()
    verdicts()
    pictures()
    teaching_message()
    scenes()
    scene_keys()
    scene_commands()
    own_joint()
    scripts()
print(f"{len(failures)} claims fail")
sys.exit(1 if failures else 0)
