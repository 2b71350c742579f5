"""A scene that both engines can be given: plain dictionaries and lists, so that it can be written, read and cut down.

    bodies      name, kind, shape and measures, position_m, rpy_deg, mass_kg, velocity_m_s, friction, friction_rule, collides
    joints      name, kind, parent, child, anchor_m, axis, slide, initial, lower, upper; `loop`: it closes a loop
    fittings    joint, friction, damping, spring, rest, balance, brake
    couplings   name, joint, of, ratio, backlash
    drives      joint, effort, lag_s: a constant force or torque behind a current loop
    belts       body, direction, speed, acceleration: what its surface does
    turntables  joint, speed, acceleration
    landing     True: a body meets another only after the start
"""

import copy
import json

RULES = ["mean", "least", "product", "greatest"]
LISTS = ["bodies", "joints", "fittings", "couplings", "drives", "belts", "turntables"]


def empty(family, seed):
    return {"family": family, "seed": seed, "gravity_m_s2": [0.0, 0.0, -9.81], "until_ms": 500, "step_us": 400,
            **{name: [] for name in LISTS}}


def body(scene, name, **keys):
    made = {"name": name, "kind": "dynamic", "rpy_deg": [0.0, 0.0, 0.0], "velocity_m_s": [0.0, 0.0, 0.0],
            "friction": 0.5, "friction_rule": "mean", "collides": False, **keys}
    scene["bodies"].append(made)
    return made


def joint(scene, name, kind, parent, child, **keys):
    made = {"name": name, "kind": kind, "parent": parent, "child": child, "initial": 0.0, "lower": None, "upper": None,
            "loop": False, **keys}
    scene["joints"].append(made)
    return made


def named(scene, part, name):
    return next(one for one in scene[part] if one["name"] == name)


def is_linear(kind):
    return kind in ("prismatic", "slot")


def has_coordinate(joint):
    return joint["kind"] in ("prismatic", "revolute", "slot")


def of_joint(scene, part, name):
    """The one entry of this part for a joint, if there is one."""
    return next((one for one in scene[part] if one["joint"] == name), None)


def pair_friction(one, other):
    """How the coefficients of two bodies combine; of two rules the later one applies."""
    rule = RULES[max(RULES.index(one["friction_rule"]), RULES.index(other["friction_rule"]))]
    a, b = one["friction"], other["friction"]
    return {"mean": (a + b) / 2, "least": min(a, b), "product": a * b, "greatest": max(a, b)}[rule]


def touching(scene):
    """Pairs of bodies that collide, one of them moving, with their friction."""
    solid = [one for one in scene["bodies"] if one["collides"]]
    joined = {frozenset((one["parent"], one["child"])) for one in scene["joints"]}
    pairs = []
    for place, one in enumerate(solid):
        for other in solid[place + 1:]:
            moves = "dynamic" in (one["kind"], other["kind"])
            if moves and frozenset((one["name"], other["name"])) not in joined:
                pairs.append((one, other, pair_friction(one, other)))
    return pairs


def free(scene):
    """Dynamic bodies that no joint holds."""
    held = {name for one in scene["joints"] for name in (one["parent"], one["child"])}
    return [one for one in scene["bodies"] if one["kind"] == "dynamic" and one["name"] not in held]


def loose(scene):
    """Dynamic bodies that hang on nothing, other bodies may hang on them."""
    hung = {one["child"] for one in scene["joints"]}
    return [one for one in scene["bodies"] if one["kind"] == "dynamic" and one["name"] not in hung]


def has_stops(scene):
    """Something comes to an end: of its way, or of its play."""
    stops = any(one["lower"] is not None or one["upper"] is not None for one in scene["joints"])
    return stops or any(one["backlash"] for one in scene["couplings"])


def is_smooth(scene):
    """Nothing meets, stops or sticks."""
    sticks = any(one.get("friction") or one.get("brake") for one in scene["fittings"])
    return not (has_stops(scene) or sticks or touching(scene) and scene["family"] != "throw")


def changed(scene):
    return copy.deepcopy(scene)


def text(scene):
    return json.dumps(scene, indent=1)
