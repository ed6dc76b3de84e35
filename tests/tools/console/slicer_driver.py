#!/usr/bin/env python3
"""Drives a command-line module of 3D Slicer by its description alone, as Slicer does.

  slicer_driver.py check SUPPLE MODULE COMMAND          judges the XML and its flags against the help
  slicer_driver.py run SUPPLE MODULE NODE=FILE ...      runs it; NODE: name of a parameter of a file

Elements, their children and attributes are those of the Slicer execution model (ModuleDescriptionParser).
Prints the standard output of the module; ends with its exit code. Standard library only.
"""
import re
import subprocess
import sys
import xml.etree.ElementTree as tree

FILES = {"image", "transform", "geometry", "pointfile", "file", "directory", "table", "measurement"}
NUMBERS = {"integer", "float", "double"}
OTHERS = {"boolean", "string", "string-enumeration", "string-vector", "point", "region"} | NUMBERS
HEAD = ["category", "title", "description", "version", "documentation-url", "license", "contributor"]
ATTRIBUTES = {
    "image": {"type": {"scalar", "label", "vector", "tensor", "diffusion-weighted", "model"}},
    "transform": {"type": {"linear", "nonlinear", "bspline"}},
    "pointfile": {"coordinateSystem": {"lps", "ras", "ijk"}},
    "geometry": {"type": {"scalar", "model", "fiberbundle"}},
}
ANYWHERE = {"fileExtensions", "multiple", "hidden", "reference"}


def description(supple, module):
    done = subprocess.run([supple, "slicer-module", module, "--xml"], capture_output=True, check=True)
    return tree.fromstring(done.stdout)


def parameters(root):
    return [p for group in root.findall("parameters") for p in group if p.tag not in ("label", "description")]


def check_parameter(parameter, names):
    children = [child.tag for child in parameter]
    known = {"name", "longflag", "label", "description", "default", "channel", "element"}
    assert parameter.tag in FILES | OTHERS, parameter.tag
    assert set(children) <= known, children
    for tag in ("name", "longflag", "label", "description"):
        assert children.count(tag) == 1 and parameter.findtext(tag), (parameter.tag, tag)
    name = parameter.findtext("name")
    assert re.fullmatch(r"[A-Za-z_]\w*", name) and name not in names, name
    names.add(name)
    for attribute, value in parameter.attrib.items():
        values = ATTRIBUTES.get(parameter.tag, {}).get(attribute)
        assert value in values if values else attribute in ANYWHERE, (name, attribute)
    assert (parameter.tag in FILES) == (parameter.findtext("channel") in ("input", "output")), name
    default = parameter.findtext("default")
    if parameter.tag == "boolean":
        assert default == "false", name
    if parameter.tag == "string-enumeration":
        elements = [e.text for e in parameter.findall("element")]
        assert default in elements and len(set(elements)) == len(elements), elements
        return elements
    assert "element" not in children, name
    return None


def check(supple, module, command):
    root = description(supple, module)
    assert root.tag == "executable" and not root.attrib
    tags = [child.tag for child in root]
    assert tags[:len(HEAD)] == HEAD and set(tags[len(HEAD):]) == {"parameters"}, tags
    for tag in ("category", "title", "description", "version"):
        assert root.findtext(tag), tag
    for group in root.findall("parameters"):
        assert [child.tag for child in group][:2] == ["label", "description"] and group.findtext("label")
    helped = subprocess.run([supple, command, "--help"], capture_output=True, check=True, text=True).stdout
    helped = helped[:helped.index("Everywhere")]
    flags = re.findall(r"^  (?:-\w,)?--([\w-]+)( \S+)?", helped, re.M)
    options = {flag: value.strip() for flag, value in flags}
    positionals = helped[helped.index("Positionals:"):helped.index("Options:")]
    options.update(re.findall(r"^  (\w+) (\S+)", positionals, re.M))
    names = set()
    for parameter in parameters(root):
        flag = parameter.findtext("longflag")
        elements = check_parameter(parameter, names)
        assert flag in options, f"{flag} is no option of {command}"
        assert (parameter.tag == "boolean") == (options[flag] == ""), flag
        if elements:
            assert elements == ["default"] + options[flag].split("|"), (flag, options[flag])
        first = parameter.findtext("description").split(" (default")[0].split()[:3]
        assert " ".join(first) in " ".join(helped.split()), first
    channels = [p.findtext("channel") for p in parameters(root)]
    assert channels.count("output") >= 1 and channels.count("input") >= 1, channels


def run(supple, module, nodes):
    words = [supple, "slicer-module", module]
    for parameter in parameters(description(supple, module)):
        value = nodes.pop(parameter.findtext("name"), parameter.findtext("default"))
        flag = "--" + parameter.findtext("longflag")
        if parameter.tag == "boolean":
            words += [flag] if value == "true" else []
        elif parameter.tag not in FILES or value:
            words += [flag, value or ""]
    assert not nodes, nodes
    return subprocess.run(words, check=False).returncode


if __name__ == "__main__":
    if sys.argv[1] == "check":
        check(*sys.argv[2:])
    else:
        sys.exit(run(sys.argv[2], sys.argv[3], dict(word.split("=", 1) for word in sys.argv[4:])))
