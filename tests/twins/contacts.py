"""Families of scenes with bodies that touch, or fly until they would."""

import numpy as np

import scene as scenes
import space


def surface(draw, scene, tilt_deg=0.0, **keys):
    """A large fixed box whose upper face goes through the origin, turned about y: downhill is x."""
    turn = space.rotation([0.0, tilt_deg, 0.0])
    centre = turn @ [0.0, 0.0, -0.5]
    scenes.body(scene, "floor", kind="fixed", shape="box", size_m=[40.0, 40.0, 1.0], floor=True, collides=True,
                position_m=[float(x) for x in centre], rpy_deg=[0.0, tilt_deg, 0.0], **coefficients(draw), **keys)
    return turn


def coefficients(draw):
    return {"friction": draw.number(0.0, 0.9, 2), "friction_rule": draw.one_of(scenes.RULES)}


def flat_box(draw):
    """A box that is lower than wide, so that it slides and does not fall over."""
    width, depth = draw.number(0.1, 0.4), draw.number(0.1, 0.4)
    return {"shape": "box", "size_m": [width, depth, round(min(width, depth) * draw.number(0.1, 0.4), 3)],
            "mass_kg": draw.wide(0.2, 20.0)}


def put(draw, scene, name, turn, along, shape, **keys):
    """On the surface at this place of it, in touch."""
    height = shape["size_m"][2] / 2
    place = turn @ [along[0], along[1], height]
    return scenes.body(scene, name, position_m=[float(x) for x in place], collides=True, **shape, **coefficients(draw), **keys)


def tilt(draw):
    return draw.number(5, 35, 1) if draw.chance(0.6) else 0.0


def slide(draw, scene):
    """A flat box on a floor or ramp, at rest or on its way."""
    slope = tilt(draw)
    turn = surface(draw, scene, slope)
    made = put(draw, scene, "box", turn, [0.0, 0.0], flat_box(draw), rpy_deg=[0.0, slope, 0.0])
    if draw.chance(0.7):
        made["velocity_m_s"] = [float(x) for x in turn @ [draw.number(-2, 2), draw.number(-2, 2), 0.0]]
    draw.clock(scene)


def roll(draw, scene):
    """A sphere, cylinder or capsule that rolls or slips down a ramp or along a floor."""
    slope = tilt(draw)
    turn = surface(draw, scene, slope)
    radius = draw.number(0.03, 0.15)
    kind = draw.one_of(["sphere", "cylinder", "capsule"])
    keys = {"shape": kind, "radius_m": radius, "mass_kg": draw.wide(0.2, 10.0)}
    rpy = [0.0, slope, 0.0]
    if kind != "sphere":
        keys["length_m"] = draw.number(0.1, 0.4)
        rpy = [90.0, slope, 0.0]
    made = scenes.body(scene, "wheel", position_m=[float(x) for x in turn @ [0.0, 0.0, radius]], rpy_deg=rpy, collides=True,
                       **keys, **coefficients(draw))
    if draw.chance(0.6) or not slope:
        sideways = draw.number(-1, 1) if kind == "sphere" else 0.0
        made["velocity_m_s"] = [float(x) for x in turn @ [draw.number(-2, 2), sideways, 0.0]]
    draw.clock(scene)


def belt(draw, scene):
    """A box on a belt that starts."""
    scenes.body(scene, "belt", kind="fixed", shape="box", size_m=[20.0, 2.0, 0.1], position_m=[0.0, 0.0, -0.05], collides=True,
                **coefficients(draw))
    scene["belts"].append({"body": "belt", "direction": draw.one_of([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]),
                           "speed": draw.number(0.1, 1.5), "acceleration": draw.one_of([0.5, 1.0, 5.0, 20.0])})
    put(draw, scene, "box", np.eye(3), [0.0, 0.0], flat_box(draw), rpy_deg=[0.0, 0.0, draw.one_of([0.0, draw.number(-90, 90, 1)])])
    if draw.chance(0.3):
        scene["bodies"][-1]["velocity_m_s"] = [draw.number(-1, 1), draw.number(-0.5, 0.5), 0.0]
    draw.clock(scene)


def table(draw, scene):
    """A box on a turntable."""
    scenes.body(scene, "table", shape="cylinder", radius_m=1.0, length_m=0.1, position_m=[0.0, 0.0, -0.05], mass_kg=50.0,
                collides=True, **coefficients(draw))
    scenes.joint(scene, "axle", "revolute", "ground", "table", anchor_m=[0.0, 0.0, 0.0], axis=[0.0, 0.0, 1.0])
    scene["turntables"].append({"joint": "axle", "speed": draw.number(0.3, 3.0), "acceleration": draw.one_of([1.0, 4.0, 8.0])})
    reach, angle = draw.number(0.0, 0.4), draw.number(0, 6.28)
    put(draw, scene, "box", np.eye(3), [reach * np.cos(angle), reach * np.sin(angle)], flat_box(draw),
        rpy_deg=[0.0, 0.0, draw.number(-90, 90, 1)])
    draw.clock(scene)


def stack(draw, scene):
    """Flat boxes on each other; the lowest one lies on a floor, or slides on a guide and is driven."""
    driven = draw.chance(0.6)
    height, below = 0.0, None
    if driven:
        shape = {"shape": "box", "size_m": [0.6, 0.6, 0.1], "mass_kg": draw.wide(1.0, 20.0)}
        scenes.body(scene, "carriage", position_m=[0.0, 0.0, 0.05], collides=True, **shape, **coefficients(draw))
        below = scenes.joint(scene, "guide", "prismatic", "ground", "carriage", anchor_m=[0.0, 0.0, 0.05], axis=[1.0, 0.0, 0.0])
        effort = float(f"{draw.sign() * shape['mass_kg'] * draw.number(0.5, 12.0):.3g}")
        scene["drives"].append({"joint": below["name"], "effort": effort, "lag_s": 0.0})
        height = 0.1
    else:
        surface(draw, scene)
    for number in range(draw.whole(1, 3)):
        shape = flat_box(draw)
        scenes.body(scene, f"b{number}", position_m=[0.0, 0.0, round(height + shape["size_m"][2] / 2, 6)], collides=True,
                    **shape, **coefficients(draw))
        height = round(height + shape["size_m"][2], 6)
    if not driven:
        scene["bodies"][-1]["velocity_m_s"] = [draw.number(-1, 1), 0.0, 0.0]
    draw.clock(scene, (3, 5))


def pusher(draw, scene):
    """A guided pusher that presses with a constant force on a box on a floor."""
    surface(draw, scene)
    shape = {"shape": "box", "size_m": [draw.number(0.2, 0.4), draw.number(0.2, 0.4), draw.number(0.1, 0.2)],
             "mass_kg": draw.wide(1.0, 100.0)}
    put(draw, scene, "box", np.eye(3), [0.0, 0.0], shape)
    face = -shape["size_m"][0] / 2
    height = shape["size_m"][2] / 2
    scenes.body(scene, "pusher", shape="box", size_m=[0.1, 0.1, 0.06], mass_kg=draw.wide(1.0, 10.0), collides=True,
                position_m=[round(face - 0.05, 6), 0.0, round(height, 6)], **coefficients(draw))
    scenes.joint(scene, "guide", "prismatic", "ground", "pusher", anchor_m=[0.0, 0.0, 0.0], axis=[1.0, 0.0, 0.0])
    effort = float(f"{shape['mass_kg'] * draw.number(1.0, 15.0):.3g}")
    scene["drives"].append({"joint": "guide", "effort": effort, "lag_s": 0.0})
    draw.clock(scene, (3, 5))


def throw(draw, scene):
    """Free bodies far from each other, thrown; they end before anything meets."""
    for number in range(draw.whole(1, 3)):
        made = scenes.body(scene, f"b{number}", position_m=[float(3 * number), 0.0, 2.0], rpy_deg=draw.angles(), collides=True,
                           **draw.shape(), **coefficients(draw))
        made["velocity_m_s"] = draw.point(1.0)
    draw.clock(scene)


def land(draw, scene):
    """A sphere that falls on a floor or ramp, and stays on it: one impact, without and with a way along."""
    turn = surface(draw, scene, tilt(draw))
    radius = draw.number(0.03, 0.15)
    place = turn @ [0.0, 0.0, radius + draw.number(0.05, 0.4)]
    scenes.body(scene, "ball", shape="sphere", radius_m=radius, mass_kg=draw.wide(0.2, 10.0), collides=True,
                position_m=[float(x) for x in place], velocity_m_s=[draw.number(-1, 1), draw.number(-1, 1), 0.0],
                **coefficients(draw))
    draw.clock(scene)
