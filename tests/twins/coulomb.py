"""A third opinion where there is one: a flat box that slides and does not turn, or a sphere, cylinder or capsule that rolls, on a
plane or on a belt, by Coulomb's law alone.

Friction is at its limit against the velocity of the contact, or what holds it. The velocity is that of the end of a step, so the
error is of first order; twice the result at a step less that at two steps has none of it.
"""

import numpy as np

import scene as scenes
import space

STEP_S = 1e-4


def path(scene, every_us):
    """Positions of the one moving body at all samples, as three runs; None where this law does not apply.

    They are one result three times, but where the body falls first: when it lands depends on the phase of a step, which nothing
    takes out, so there the runs differ by their steps."""
    moving = [one for one in scene["bodies"] if one["kind"] == "dynamic"]
    under = [one for one in scene["bodies"] if one["kind"] == "fixed"]
    if len(moving) != 1 or len(under) != 1 or scene["joints"] or len(scenes.touching(scene)) != 1:
        return None
    fine, coarse = (integrated(scene, moving[0], under[0], every_us, step) for step in (STEP_S, 2 * STEP_S))
    best = 2 * fine - coarse
    runs = [coarse, fine, best] if scene["family"] == "land" else [best] * 3
    return [{f"{moving[0]['name']}.p0.{axis}": run[:, number] for number, axis in enumerate("xyz")} for run in runs]


def inertia_share(body):
    """m R^2 / I of what rolls; 0 of a box, which does not turn."""
    shape, radius = body["shape"], body.get("radius_m", 0.0)
    if shape == "box":
        return 0.0
    if shape == "sphere":
        return 2.5
    if shape == "cylinder":
        return 2.0
    length = body["length_m"]
    # a capsule: a cylinder and two half spheres, by their volumes
    barrel, caps = length, 4 / 3 * radius
    return (barrel + caps) / (barrel / 2 + caps * 2 / 5)


def integrated(scene, body, under, every_us, step):
    turn = space.rotation(under["rpy_deg"])
    top = np.array(under["position_m"]) + turn @ [0, 0, under["size_m"][2] / 2]
    gravity = turn.T @ np.array(scene["gravity_m_s2"])
    place, velocity = turn.T @ (np.array(body["position_m"]) - top), turn.T @ np.array(body["velocity_m_s"])
    height = body["size_m"][2] / 2 if body["shape"] == "box" else body["radius_m"]
    friction, share = scenes.touching(scene)[0][2], inertia_share(body)
    belt = next(iter(scene["belts"]), None)
    along = turn.T @ np.array(belt["direction"]) if belt else np.zeros(3)
    rolled = np.zeros(3)
    found = [place.copy()]
    steps = round(every_us * 1e-6 / step)
    for number in range(1, scene["until_ms"] * 1000 // every_us * steps + 1):
        velocity = velocity + gravity * step
        pressed = 0.0
        if place[2] + velocity[2] * step <= height:
            pressed = (height - place[2]) / step - velocity[2]
            velocity[2] += pressed
        surface = along * min(belt["speed"], belt["acceleration"] * number * step) if belt else along
        slip = velocity - rolled - surface
        slip[2] = 0.0
        size = np.linalg.norm(slip)
        if size > 0 and pressed > 0:
            impulse = -slip / size * min(friction * pressed, size / (1 + share))
            velocity = velocity + impulse
            rolled = rolled - share * impulse
        place = place + velocity * step
        if number % steps == 0:
            found.append(place.copy())
    return np.array(found) @ turn.T + top
