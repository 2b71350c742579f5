"""One file: what it is, whether onescan reads it, and how far its numbers are from the other program's."""

import math
import random
import re
import subprocess
import traceback

import numpy

import ours
import theirs

LOADS, WITH_DENSITY, OURS, HARNESS = "loads", "loads with a density", "refused", "harness"
BOUND = 1e-9


class Result:
    """A file's kind (see theirs.py, or one of the above), why, and its comparison if there is one."""

    def __init__(self, file, kind, text=""):
        self.file, self.kind, self.text = file, kind, text
        self.joints, self.mass, self.gravity, self.apart = 0, None, None, ""

    @property
    def is_compared(self):
        return self.mass is not None

    @property
    def is_equal(self):
        return self.is_compared and not self.apart


def one(work):
    """Runs in a process of its own; what breaks the harness is reported as such."""
    given, program, folder, file, packages, parts = work
    try:
        return judged(given, program, folder, file, packages, parts)
    except subprocess.TimeoutExpired:
        return Result(file, OURS, f"not read in {given.limit} s")
    except ChildProcessError as broke:
        return Result(file, OURS, f"it broke: {broke}")
    except Exception:
        return Result(file, HARNESS, traceback.format_exc())


def judged(given, program, folder, file, packages, parts):
    verdict = theirs.of(file, packages, parts)
    if verdict.kind != theirs.WHOLE:
        return Result(file, verdict.kind, verdict.text)

    def read(keys, dynamics=False):
        return ours.read(program, folder, file, packages, keys, given.limit, dynamics)

    keys = {}
    reading = read(keys)
    if reading.refused and "has no mass" in reading.refused:
        keys["density_kg_m3"] = 2700
        reading = read(keys)
    if reading.refused:
        return Result(file, OURS, said(reading.refused))
    result = Result(file, WITH_DENSITY if keys else LOADS)
    if not keys and given.poses:
        compare(given, result, verdict.model, reading.data, read)
    return result


def said(refused):
    """The cause of a diagnostic, without pictures of the text."""
    lines = [line.strip(" ×│╭╰─▶·") for line in refused.splitlines()]
    lines = [line for line in lines if line and not re.match(r"^(\d+ │|\[|here$|scene::)", line)]
    return " ".join(lines)[:400]


def compare(given, result, model, data, read):
    """Mass matrix and gravity forces at random poses, the same for the same file."""
    stands = ours.coordinates(data)
    free = [joint for joint in model.joints() if joint[0] in stands]
    result.joints = len(free)
    if not free:
        return
    chance = random.Random(result.file.path.name)
    follows = ours.followers(data)
    worst = [0.0, 0.0]
    for _ in range(given.poses):
        pose = {name: drawn(chance, slides, limits) for name, slides, limits in free if name not in follows}
        slides = {name for name, slides, _ in free if slides}
        keys = {}
        for key, wanted in [("initial_rad", False), ("initial_m", True)]:
            named = [f"{ours.text(name)} = {float(value)!r}" for name, value in pose.items() if (name in slides) == wanted]
            if named:
                keys[key] = "{ " + ", ".join(named) + " }"
        reading = read(keys, dynamics=True)
        if reading.refused:
            result.apart = f"at a pose: {said(reading.refused)}"
            return
        errors = differences(model, reading.data)
        if errors is None:
            # a base that floats, or a loop: the engine moves it
            result.text = "not compared: it stands on nothing fixed"
            return
        worst = [max(pair) for pair in zip(worst, errors)]
    result.mass, result.gravity = worst
    if max(worst) > BOUND:
        result.apart = f"mass matrix by {worst[0]:.1e}, gravity by {worst[1]:.1e}"


def drawn(chance, slides, limits):
    lower, upper = limits
    if not (math.isfinite(lower) and math.isfinite(upper)):
        lower, upper = (-0.5, 0.5) if slides else (-math.pi, math.pi)
    # not on a limit, which another program may have in other digits
    return chance.uniform(lower + 0.01 * (upper - lower), upper - 0.01 * (upper - lower))


def differences(model, data):
    """The greatest difference of the mass matrix and of gravity, by the greatest entry of each."""
    names, gravity, mass = model.at(ours.coordinates(data))
    own_mass, own_gravity, seen = numpy.zeros_like(mass), numpy.zeros_like(gravity), 0
    row = {name: index for index, name in enumerate(names)}
    for mechanism in data["dynamics"]:
        joints = [joint.removeprefix(ours.NAME + ".") for joint in mechanism["joints"]]
        rows = [row[joint] for joint in joints if joint in row]
        own = [index for index, joint in enumerate(joints) if joint in row]
        own_mass[numpy.ix_(rows, rows)] = numpy.array(mechanism["mass_matrix"])[numpy.ix_(own, own)]
        own_gravity[rows] = numpy.array(mechanism["gravity"])[own]
        seen += len(rows)
    if seen != len(names):
        return None
    # a robot whose axes all stand upright holds nothing: by a millimetre of its weight
    weight = 9.81 * 0.001 * model.mass_kg
    return (float(abs(own_mass - mass).max() / abs(mass).max()),
            float(abs(own_gravity - gravity).max() / max(abs(gravity).max(), weight)))
