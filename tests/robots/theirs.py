"""A file as ROS's xacro and Pinocchio, or MuJoCo, have it."""

import contextlib
import io
import math
import re
import xml.etree.ElementTree as tree
from pathlib import Path

import mujoco
import numpy
import pinocchio
import xacro
import xacro.substitution_args

# a body of less is a frame to onescan (docs/plant.md)
MASS_MIN_KG = 1e-6
SLIDE, HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)
GRAVITY = [0.0, 0.0, -9.81]

WHOLE, FRAGMENT, INCOMPLETE, WANTS, REFUSED = "whole", "fragment", "incomplete", "wants arguments", "refused by its own program"


class Missing(Exception):
    """A package or a file that the folder does not have."""


class Verdict:
    """What a file is to the programs that it was written for."""

    def __init__(self, kind, text="", model=None):
        self.kind, self.text, self.model = kind, text, model


def of(file, packages, parts):
    if file.kind == "mujoco":
        return of_mujoco(file, parts)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return of_ros(file, packages)


def of_mujoco(file, parts):
    try:
        model = mujoco.MjModel.from_xml_path(str(file.path))
    except Exception as failed:
        text = " ".join(str(failed).split())
        lost = "Error opening file" in text or "resource not found" in text or "could not open" in text.lower()
        if str(file.path).endswith(parts):
            return Verdict(FRAGMENT, f"others include it: {text}")
        return Verdict(INCOMPLETE if lost else REFUSED, text)
    if model.nbody <= 1:
        return Verdict(FRAGMENT, "it has no body")
    return Verdict(WHOLE, model=Mujoco(model))


def of_ros(file, packages):
    def find(name):
        if name not in packages:
            raise Missing(f"package {name}")
        return str(packages[name])

    xacro.substitution_args._eval_find = find
    xacro.substitution_args._eval_dict["find"] = find
    try:
        if file.path.suffix == ".xacro":
            text = xacro.process_file(str(file.path), mappings=dict(file.arguments)).toxml()
        else:
            text = re.sub(r"\A.*?(?=<(\?xml|robot))", "", file.path.read_bytes().decode("utf-8-sig", "replace"), flags=re.S)
        robot = tree.fromstring(text.encode() if "encoding" in text[:80] else text)
    except Exception as failed:
        return unexpanded(failed)
    if not robot.findall("link"):
        return Verdict(FRAGMENT, "it has no link")
    if hangs_elsewhere(robot) and file.path.suffix == ".xacro":
        return Verdict(FRAGMENT, "it hangs on a link of another file")
    lost = missing_meshes(robot, file.path, packages)
    if lost:
        return Verdict(INCOMPLETE, f"mesh {lost[0]}")
    with_our_frames(robot)
    try:
        model = pinocchio.buildModelFromXML(tree.tostring(robot, encoding="unicode"))
    except Exception as failed:
        return Verdict(REFUSED, f"Pinocchio: {' '.join(str(failed).split())}")
    return Verdict(WHOLE, model=Ros(model))


def hangs_elsewhere(robot):
    """True if a joint has a link that is not in the file."""
    links = {link.get("name") for link in robot.findall("link")}
    return any(end.get("link") not in links for joint in robot.findall("joint") for end in joint if end.tag in ("parent", "child"))


def unexpanded(failed):
    """Why xacro made nothing of a file."""
    text = " ".join(f"{type(failed).__name__}: {failed}".split())
    causes, cause = [], failed
    while cause is not None:
        causes.append(cause)
        cause = cause.__cause__ or getattr(cause, "exc", None)
    if any(isinstance(cause, (Missing, FileNotFoundError)) for cause in causes) or "No such file" in text:
        return Verdict(INCOMPLETE, text)
    return Verdict(WANTS if "Undefined substitution argument" in text or "ArgException" in text else REFUSED, text)


def missing_meshes(robot, path, packages):
    """Meshes of collision shapes that are not in the folder."""
    lost = []
    for mesh in robot.iterfind(".//collision/geometry/mesh"):
        name = mesh.get("filename") or ""
        packaged = re.match(r"(?:package|model)://([^/]+)/(.*)", name)
        if packaged:
            place = packages.get(packaged[1])
            there = place is not None and (place / packaged[2]).is_file()
            # a package that was copied without its name
            there = there or any((up / packaged[2]).is_file() for up in list(path.parents)[:9])
        else:
            bare = name.removeprefix("file://").lstrip("/") if name.startswith("file:") else name
            there = (path.parent / bare).is_file() or Path("/" + bare).is_file()
        if not there:
            lost.append(name)
    return lost


def with_our_frames(robot):
    """Masses as docs/plant.md says that onescan reads them."""
    for link in robot.findall("link"):
        inertial = link.find("inertial")
        mass = inertial.find("mass") if inertial is not None else None
        if mass is None:
            continue
        kg = float(mass.get("value", "nan"))
        if kg < MASS_MIN_KG:
            link.remove(inertial)
            continue
        inertia = inertial.find("inertia")
        if inertia is None:
            inertia = tree.SubElement(inertial, "inertia")
        xx, yy, zz, xy, xz, yz = (float(inertia.get(key, 0)) for key in ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"])
        minor = xx * yy - xy * xy
        whole = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
        if not (xx > 0 and minor > 0 and whole > 0):
            radius = (kg / (2700.0 * 4.0 / 3.0 * math.pi)) ** (1.0 / 3.0)
            for key in ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]:
                inertia.set(key, repr(0.4 * kg * radius * radius if key[1] == key[2] else 0.0))


class Ros:
    """A robot in Pinocchio."""

    def __init__(self, model):
        self.model = model
        self.data = model.createData()
        model.gravity.linear = numpy.array(GRAVITY)
        self.mass_kg = sum(inertia.mass for inertia in model.inertias)

    def joints(self):
        """Joints of one coordinate, with where they may stand."""
        for index in range(1, self.model.njoints):
            joint = self.model.joints[index]
            if joint.nv == 1:
                at = joint.idx_q
                lower, upper = self.model.lowerPositionLimit[at], self.model.upperPositionLimit[at]
                slides = "JointModelP" in joint.shortname()
                yield self.model.names[index], slides, (lower, upper) if joint.nq == 1 else (-math.inf, math.inf)

    def at(self, coordinates):
        """Names, gravity and mass matrix with joints where `coordinates` say."""
        q = pinocchio.neutral(self.model)
        rows, names = [], []
        for index in range(1, self.model.njoints):
            joint, name = self.model.joints[index], self.model.names[index]
            if joint.nv != 1 or name not in coordinates:
                continue
            rows.append(joint.idx_v)
            names.append(name)
            value = coordinates[name]
            q[joint.idx_q:joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [math.cos(value), math.sin(value)]
        mass = pinocchio.crba(self.model, self.data, q)
        mass = numpy.triu(mass) + numpy.triu(mass, 1).T
        gravity = pinocchio.computeGeneralizedGravity(self.model, self.data, q)
        return names, gravity[rows], mass[numpy.ix_(rows, rows)]


class Mujoco:
    """A robot in MuJoCo, without what simulators add to it."""

    def __init__(self, model):
        self.model = model
        model.opt.gravity[:] = GRAVITY
        model.dof_armature[:] = 0.0
        model.body_gravcomp[:] = 0.0
        if model.ntendon:
            model.tendon_armature[:] = 0.0
        light = model.body_mass < MASS_MIN_KG
        model.body_mass[light], model.body_inertia[light] = 0.0, 0.0
        self.mass_kg = float(model.body_mass.sum())

    def named(self):
        for index in range(self.model.njnt):
            kind = int(self.model.jnt_type[index])
            if kind in (SLIDE, HINGE):
                name = self.model.joint(index).name or self.model.body(self.model.jnt_bodyid[index]).name
                yield index, name, kind == SLIDE

    def joints(self):
        for index, name, slides in self.named():
            limits = tuple(self.model.jnt_range[index]) if self.model.jnt_limited[index] else (-math.inf, math.inf)
            yield name, slides, limits

    def at(self, coordinates):
        data = mujoco.MjData(self.model)
        rows, names = [], []
        for index, name, _ in self.named():
            if name in coordinates:
                data.qpos[self.model.jnt_qposadr[index]] = coordinates[name]
                rows.append(self.model.jnt_dofadr[index])
                names.append(name)
        mujoco.mj_forward(self.model, data)
        mass = numpy.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, data, mass)
        return names, data.qfrc_bias[rows].copy(), mass[numpy.ix_(rows, rows)]
