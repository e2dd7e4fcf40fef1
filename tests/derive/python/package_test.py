"""The package as a whole: its tutorial runs, its stubs name what there is, every part has words."""
import ast
import doctest
import inspect
import os
import re
import unittest

import cdot
from cdot import _cdot

source = os.environ["CDOT_SOURCE_DIR"]
package = f"{source}/derive/python"


def members_of(stub, name):
    """Functions of a class of the stubs, with those of its bases: name -> names of the arguments, by overload."""
    node = stub[name]
    found = {}
    for base in node.bases:
        if base.id in stub:
            found.update(members_of(stub, base.id))
    for each in node.body:
        if isinstance(each, ast.FunctionDef):
            arguments = [argument.arg for argument in each.args.args if argument.arg != "self"]
            found.setdefault(each.name, []).append(arguments)
        elif isinstance(each, ast.AnnAssign):
            found[each.target.id] = []
    return found


def arguments_of(function):
    """The names of the arguments, by overload, in the lines that pybind11 writes: f(self: T, h: float = 1) -> T"""
    lines = [line for line in function.__doc__.splitlines() if re.match(rf"(\d+\. )?{function.__name__}\(", line)]
    inside = [re.search(r"\((.*)\) -> ", line) for line in lines]
    return [[name for name in re.findall(r"(?:^|, )(\w+):", each.group(1)) if name != "self"] for each in inside if each]


class Package(unittest.TestCase):
    def run_page(self, page, least):
        """Every example of a page in Markdown, in its order."""
        with open(page, encoding="utf-8") as file:
            text = re.sub(r"^```.*$", "", file.read(), flags=re.MULTILINE)
        examples = doctest.DocTestParser().get_doctest(text, {}, page, page, 0)
        self.assertGreaterEqual(len(examples.examples), least)
        report = []
        result = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=report.append)
        self.assertEqual(result.failed, 0, "".join(report))

    def test_tutorial(self):
        self.run_page(f"{package}/README.md", 50)

    def test_front_page(self):
        self.run_page(f"{source}/README.md", 4)

    def test_stubs_name_what_there_is(self):
        with open(f"{package}/cdot/_cdot.pyi", encoding="utf-8") as file:
            tree = ast.parse(file.read())
        stub = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        classes = {name for name, each in vars(_cdot).items() if inspect.isclass(each)}
        self.assertEqual(classes, {name for name in stub if name != "_AnyWorld"})
        for name in classes - {"Error", "SceneError", "NoSuchSpec", "CannotEmit"}:
            there = {key: value for key, value in vars(getattr(_cdot, name)).items()
                     if not key.startswith("__") or key == "__init__"}
            if name == "Snapshot" or name == "Result":
                there.pop("__init__")  # Python makes none
            said = members_of(stub, name)
            self.assertEqual(set(there), set(said), name)
            for key, value in there.items():
                if not isinstance(value, property):
                    function = value.__func__ if isinstance(value, staticmethod) else value
                    self.assertEqual(arguments_of(function), said[key], f"{name}.{key}")

    def test_every_part_has_words(self):
        for name in cdot.__all__:
            part = getattr(cdot, name)
            if inspect.isclass(part) and not issubclass(part, Exception):
                for key, value in vars(part).items():
                    if key.startswith("_") or not (callable(value) or isinstance(value, (property, staticmethod))):
                        continue
                    words = value.__doc__ or ""
                    self.assertGreater(len(words.splitlines()[-1] if "->" in words else words), 5, f"{name}.{key}")
            self.assertTrue(part.__doc__, name)


if __name__ == "__main__":
    unittest.main()
