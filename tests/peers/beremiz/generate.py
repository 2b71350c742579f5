"""Structured Text that the generator of Beremiz makes of networks, without its windows.

    generate.py BEREMIZ FOLDER

BEREMIZ is a checkout of github.com/beremiz/beremiz, FOLDER holds projects in PLCopen XML. Beside each `NAME.xml` it
writes `NAME.st`, and none if the generator fails: in Python 3 it cannot sort some of the lines that end at one point.
Python needs lxml. What the schema demands but networks do not need, such as sizes, is added first.
"""

import builtins
import os
import sys
import types
from pathlib import Path

NS = "{http://www.plcopen.org/xml/tc6_0201}"


class Window:
    """Whatever is asked of a library of windows."""

    def __init__(self, *_, **__):
        pass

    def __call__(self, *_, **__):
        return Window()

    def __getattr__(self, _):
        return Window()

    def __getitem__(self, _):
        return Window()

    def __add__(self, _):
        return self

    __or__ = __add__


class Windows(types.ModuleType):
    """A module of which only names are wanted."""

    __path__ = []
    __all__ = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return Window()


def load(beremiz):
    for name in ("wx", "wx.lib", "wx.adv", "wx.grid", "wx.stc", "graphics", "graphics.GraphicCommons"):
        sys.modules[name] = Windows(name)
    builtins._ = lambda text: text
    sys.path.insert(0, str(beremiz))
    os.chdir(beremiz)
    import PLCControler

    return PLCControler.PLCControler


def complete(etree, text):
    """The project with what the schema wants."""
    root = etree.fromstring(text)

    def new(tag, **attributes):
        return etree.Element(NS + tag, {key: str(value) for key, value in attributes.items()})

    header = root.find(NS + "fileHeader")
    moment = "2024-01-01T00:00:00"
    header.attrib.update({"companyName": "Unknown", "productVersion": "1", "creationDateTime": moment})
    content = new("contentHeader", name="Unnamed", modificationDateTime=moment)
    info = etree.SubElement(content, NS + "coordinateInfo")
    for language in ("fbd", "ld", "sfc"):
        etree.SubElement(etree.SubElement(info, NS + language), NS + "scaling", x="8", y="8")
    header.addnext(content)
    for body in root.iter(NS + "body"):
        for written in body.iter(NS + "ST"):
            paragraph = etree.SubElement(written, "{http://www.w3.org/1999/xhtml}p")
            paragraph.text, written.text = written.text, None
        for element in body.iter():
            kind = etree.QName(element).localname
            if element.find(NS + "position") is not None and "localId" in element.attrib:
                element.attrib.update({"width": "40", "height": "20"})
            if kind in ("connectionPointIn", "connectionPointOut") and element.find(NS + "relPosition") is None:
                element.insert(0, new("relPosition", x=0, y=0))
            if kind == "connection" and not len(element):
                element.extend([new("position", x=0, y=0), new("position", x=0, y=0)])
            if kind == "variable" and element.get("formalParameter") and not len(element):
                element.append(new("connectionPointIn"))
                element[0].append(new("relPosition", x=0, y=0))
    return etree.tostring(root, xml_declaration=True, encoding="utf-8")


def main():
    beremiz, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    from lxml import etree

    controller = load(beremiz)
    for path in sorted(folder.glob("*.xml")):
        completed = path.with_suffix(".beremiz")
        completed.write_bytes(complete(etree, path.read_bytes()))
        project = controller()
        problem = project.OpenXMLFile(str(completed))
        try:
            text, errors, _ = project.GenerateProgram(noconfig=True)
        except TypeError as error:
            print(f"{path.name}: {error}")
            continue
        if problem or errors:
            sys.exit(f"{path.name}: {problem} {[str(error) for error in errors]}")
        path.with_suffix(".st").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
