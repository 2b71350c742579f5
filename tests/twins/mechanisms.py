"""Families of scenes without contact: trees of joints, gears, loops, what floats."""

import numpy as np

import scene as scenes


def hang(draw, scene, count, kinds):
    """Adds bodies, each on a joint to the ground or to one before it."""
    names = [one["name"] for one in scene["bodies"] if one["kind"] == "dynamic"]
    for _ in range(count):
        number = len(names)
        parent = draw.one_of(["ground", *names]) if draw.chance(0.3) or not names else names[-1]
        base = np.array([0.0, 0.0, 2.0]) if parent == "ground" else np.array(scenes.named(scene, "bodies", parent)["position_m"])
        anchor = [round(float(x), 3) for x in base + draw.point(0.2)]
        place = [round(float(x), 3) for x in anchor + np.array(draw.point(0.3))]
        kind = draw.one_of(kinds)
        scenes.body(scene, f"b{number}", position_m=place, rpy_deg=draw.angles(), **draw.shape())
        keys = {} if kind == "ball" else {"axis": draw.axis()}
        if kind == "slot":
            across = np.cross(keys["axis"], draw.direction())
            keys["slide"] = [float(x) for x in across / np.linalg.norm(across)]
        made = scenes.joint(scene, f"j{number}", kind, parent, f"b{number}", anchor_m=anchor, **keys)
        if kind in ("prismatic", "revolute") and draw.chance(0.3):
            made["initial"] = draw.number(-1, 1)
        names.append(f"b{number}")


def moved(scene):
    return [one for one in scene["joints"] if one["kind"] in ("prismatic", "revolute") and not one["loop"]]


def weight(scene, joint):
    """Force or torque of the order of what the joint carries."""
    mass = scenes.named(scene, "bodies", joint["child"])["mass_kg"]
    return mass * (10.0 if joint["kind"] == "prismatic" else 1.5)


def fit(draw, scene, joint, friction=0.0):
    """A fitting of a joint: spring, damper, counterweight and, with this probability, dry friction or a brake."""
    load = weight(scene, joint)
    inertia = load / (10.0 if joint["kind"] == "prismatic" else 40.0)
    made = {"joint": joint["name"]}
    if draw.chance(0.5):
        made["spring"] = float(f"{inertia * draw.wide(2.0, 40.0) ** 2:.3g}")
        made["rest"] = round(joint["initial"] + draw.number(-0.3, 0.3), 3)
    if draw.chance(0.4):
        made["damping"] = float(f"{inertia * draw.wide(0.1, 20.0):.3g}")
    if draw.chance(0.3):
        made["balance"] = float(f"{draw.number(-1, 1) * load:.3g}")
    if draw.chance(friction):
        made["friction"] = float(f"{load * draw.wide(0.02, 1.0):.3g}")
        if draw.chance(0.2):
            made["brake"] = float(f"{load * draw.wide(0.1, 2.0):.3g}")
    if len(made) > 1:
        scene["fittings"].append(made)


def push(draw, scene, joint):
    effort = float(f"{draw.number(-2, 2) * weight(scene, joint):.3g}")
    scene["drives"].append({"joint": joint["name"], "effort": effort, "lag_s": draw.one_of([0.0, 0.001, 0.02])})


def gravity(draw, scene):
    if draw.chance(0.2):
        scene["gravity_m_s2"] = [round(9.81 * x, 3) for x in draw.direction()] if draw.chance(0.7) else [0.0, 0.0, 0.0]


def tree(draw, scene):
    """A tree of prismatic and revolute joints, with springs, dampers, constant forces and drives."""
    hang(draw, scene, draw.whole(1, 5), ["prismatic", "revolute", "revolute"])
    for joint in moved(scene):
        if draw.chance(0.6):
            fit(draw, scene, joint)
        if draw.chance(0.2):
            push(draw, scene, joint)
    gravity(draw, scene)
    draw.clock(scene)


def friction(draw, scene):
    """The same with dry friction and brakes."""
    hang(draw, scene, draw.whole(1, 4), ["prismatic", "revolute"])
    for joint in moved(scene):
        fit(draw, scene, joint, 0.7)
        if draw.chance(0.3):
            push(draw, scene, joint)
    gravity(draw, scene)
    draw.clock(scene)


def stop(draw, scene):
    """The same with hard stops."""
    hang(draw, scene, draw.whole(1, 3), ["prismatic", "revolute"])
    for joint in moved(scene):
        if draw.chance(0.7):
            joint["lower"] = round(joint["initial"] - draw.number(0, 0.4), 3)
            joint["upper"] = round(joint["initial"] + draw.number(0, 0.4) + 0.001, 3)
        if draw.chance(0.5):
            fit(draw, scene, joint, 0.3)
        if draw.chance(0.3):
            push(draw, scene, joint)
    gravity(draw, scene)
    draw.clock(scene)


def pins(draw, scene):
    """Ball joints and pins in slots."""
    hang(draw, scene, draw.whole(1, 3), ["ball", "slot", "revolute", "prismatic"])
    for joint in moved(scene):
        if draw.chance(0.4):
            fit(draw, scene, joint)
    gravity(draw, scene)
    draw.clock(scene, (3, 6))


def gear(draw, scene):
    """Joints that lead others: gears, racks, differentials, some with play."""
    count = draw.whole(2, 4)
    hang(draw, scene, count, ["prismatic", "revolute"])
    joints = moved(scene)
    for number in range(draw.whole(1, count - 1)):
        led, before = joints[number + 1], joints[:number + 1]
        of = draw.random.sample(before, 2) if len(before) > 1 and draw.chance(0.3) else [draw.one_of(before)]
        ratio = [round(draw.sign() * draw.wide(0.1, 5.0), 4) for _ in of]
        # a gear meshes in the scene's pose: its law has no offset
        for one in [led, *of]:
            one["initial"] = 0.0
        play = draw.number(0.002, 0.05) if draw.chance(0.25) else 0.0
        scene["couplings"].append({"name": f"c{number}", "joint": led["name"], "of": [one["name"] for one in of],
                                   "ratio": ratio, "backlash": play})
    for joint in joints:
        if draw.chance(0.4):
            fit(draw, scene, joint, 0.3)
        if draw.chance(0.4):
            push(draw, scene, joint)
    gravity(draw, scene)
    draw.clock(scene)


def bar(draw, scene, name, start, end):
    middle, along = (start + end) / 2, end - start
    yaw = float(np.degrees(np.arctan2(along[1], along[0])))
    size = [round(float(np.linalg.norm(along)), 4), draw.number(0.02, 0.06), draw.number(0.02, 0.06)]
    scenes.body(scene, name, position_m=[float(x) for x in middle], rpy_deg=[0.0, 0.0, yaw], shape="box", size_m=size,
                mass_kg=draw.wide(0.2, 5.0))


def loop(draw, scene):
    """A four-bar linkage in the plane of x and y, or a crank with a slider; gravity lies in that plane."""
    crank, angle = draw.number(0.1, 0.3), draw.number(0.3, 2.8)
    a, axis = np.zeros(3), [0.0, 0.0, 1.0]
    b = np.array([crank * np.cos(angle), crank * np.sin(angle), 0.0])
    bar(draw, scene, "crank", a, b)
    scenes.joint(scene, "j0", "revolute", "ground", "crank", anchor_m=[0.0, 0.0, 0.0], axis=axis)
    if draw.chance(0.4):
        c = np.array([b[0] + draw.number(0.35, 0.7), 0.0, 0.0])
        bar(draw, scene, "rod", b, c)
        scenes.body(scene, "slider", position_m=[float(x) for x in c], shape="box", size_m=[0.1, 0.06, 0.06],
                    mass_kg=draw.wide(0.2, 5.0))
        scenes.joint(scene, "j1", "revolute", "crank", "rod", anchor_m=[float(x) for x in b], axis=axis)
        scenes.joint(scene, "j2", "prismatic", "ground", "slider", anchor_m=[float(x) for x in c], axis=[1.0, 0.0, 0.0])
        scenes.joint(scene, "j3", "revolute", "slider", "rod", anchor_m=[float(x) for x in c], axis=axis, loop=True)
    else:
        d = np.array([draw.number(0.3, 0.7), draw.number(-0.1, 0.1), 0.0])
        c = d + np.array([draw.number(-0.1, 0.3), draw.number(0.3, 0.5), 0.0])
        bar(draw, scene, "rod", b, c)
        bar(draw, scene, "rocker", d, c)
        scenes.joint(scene, "j1", "revolute", "crank", "rod", anchor_m=[float(x) for x in b], axis=axis)
        scenes.joint(scene, "j2", "revolute", "ground", "rocker", anchor_m=[float(x) for x in d], axis=axis)
        scenes.joint(scene, "j3", "revolute", "rocker", "rod", anchor_m=[float(x) for x in c], axis=axis, loop=True)
    scene["gravity_m_s2"] = draw.one_of([[0.0, -9.81, 0.0], [0.0, 0.0, 0.0], [9.81, 0.0, 0.0]])
    if draw.chance(0.5) or not any(scene["gravity_m_s2"]):
        push(draw, scene, scene["joints"][0])
    if draw.chance(0.3):
        fit(draw, scene, draw.one_of([scene["joints"][0], scene["joints"][2]]), 0.3)
    draw.clock(scene, (3, 5))


def floating(draw, scene):
    """Bodies joined to each other and to nothing else, in free fall or without weight."""
    scenes.body(scene, "b0", position_m=[0.0, 0.0, 2.0], rpy_deg=draw.angles(), **draw.shape())
    scene["bodies"][0]["velocity_m_s"] = draw.point(1.0)
    count = draw.whole(1, 3)
    for number in range(1, count + 1):
        parent = f"b{draw.whole(0, number - 1)}"
        anchor = [round(float(x), 3) for x in np.array(scenes.named(scene, "bodies", parent)["position_m"]) + draw.point(0.2)]
        place = [round(float(x), 3) for x in np.array(anchor) + draw.point(0.3)]
        scenes.body(scene, f"b{number}", position_m=place, rpy_deg=draw.angles(), **draw.shape())
        kind = draw.one_of(["prismatic", "revolute", "ball"])
        keys = {} if kind == "ball" else {"axis": draw.axis()}
        # all begin with one velocity, so that no joint is torn at the start
        scene["bodies"][-1]["velocity_m_s"] = scene["bodies"][0]["velocity_m_s"]
        made = scenes.joint(scene, f"j{number}", kind, parent, f"b{number}", anchor_m=anchor, **keys)
        if kind != "ball" and draw.chance(0.8):
            fit(draw, scene, made)
        if kind != "ball" and draw.chance(0.4):
            push(draw, scene, made)
    if draw.chance(0.5):
        scene["gravity_m_s2"] = [0.0, 0.0, 0.0]
    draw.clock(scene, (3, 6))
