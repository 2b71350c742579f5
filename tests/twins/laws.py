"""What must hold of a run of onescan by itself, whatever another engine says.

Each law gives how far it is broken at each of the three steps, in its own unit. Velocities are means over a step, and contacts
give a little, so a law is broken by something that goes to zero with the step; what does not is a finding.
"""

import mujoco
import numpy as np

import bound
import scene as scenes
import space
import theirs

# What a contact gives at any step, m, and the part of it in forces.
SINKING = 2e-5
SHARE = 2e-3


def broken(scene, runs, every_us):
    """Name, how far it is broken at the finest step, and the bound; of each law that applies."""
    laws = [("energy", energy, 1e-6), ("momentum", momentum, bound.FLOOR), ("sinking", sinking, SINKING), ("friction", cone, SHARE)]
    found = []
    for name, law, floor in laws:
        amounts = [law(scene, run, every_us) for run in runs]
        if amounts[0] is None:
            continue
        coarse, middle, fine = amounts
        limit = bound.SAFETY * max(abs(fine - middle), abs(middle - coarse) / 2) + floor
        found.append((name, fine, limit))
    return found


def energy(scene, run, _):
    """By how much the energy grows of a tree that nobody drives, as a share of what it moves. All coordinates must be known."""
    known = all(one["kind"] in ("prismatic", "revolute") for one in scene["joints"])
    if not scene["joints"] or not known or scenes.loose(scene) or scene["drives"] or scene["turntables"] or scene["belts"]:
        return None
    model = mujoco.MjModel.from_xml_string(theirs.mjcf(scene, 100))
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    data = mujoco.MjData(model)
    joints = [one["name"] for one in scene["joints"] if not one["loop"]]
    places = [(f"{name}.q", f"{name}.v", model.joint(name).qposadr[0], model.joint(name).dofadr[0]) for name in joints]
    pulls = [(f"{one['joint']}.q", one["balance"]) for one in scene["fittings"] if one.get("balance")]
    values, moving = [], []
    for sample in range(len(run[places[0][0]])):
        for q, v, qpos, dof in places:
            data.qpos[qpos], data.qvel[dof] = run[q][sample], run[v][sample]
        mujoco.mj_forward(model, data)
        values.append(sum(data.energy) - sum(force * run[q][sample] for q, force in pulls))
        moving.append(data.energy[1])
    values = np.array(values)
    least = np.minimum.accumulate(values)
    return float(np.max(values - least)) / (max(moving) + 1e-3)


def momentum(scene, run, every_us):
    """How far the common centre of mass is from its parabola, where nothing holds or meets it."""
    if scenes.touching(scene) and scene["family"] != "throw" or not scenes.loose(scene):
        return None
    if any(one["parent"] == "ground" for one in scene["joints"]) or any(one["kind"] != "dynamic" for one in scene["bodies"]):
        return None
    mass = np.array([one["mass_kg"] for one in scene["bodies"]])
    times = np.arange(scene["until_ms"] * 1000 // every_us + 1) * every_us * 1e-6
    worst = 0.0
    for place, axis in enumerate("xyz"):
        is_at = sum(m * run[f"{one['name']}.p0.{axis}"] for m, one in zip(mass, scene["bodies"])) / mass.sum()
        start = sum(m * one["position_m"][place] for m, one in zip(mass, scene["bodies"])) / mass.sum()
        speed = sum(m * one["velocity_m_s"][place] for m, one in zip(mass, scene["bodies"])) / mass.sum()
        parabola = start + speed * times + scene["gravity_m_s2"][place] * times ** 2 / 2
        worst = max(worst, float(np.max(np.abs(is_at - parabola))))
    return worst


def under(scene):
    """The one fixed body that everything lies on."""
    fixed = [one for one in scene["bodies"] if one["kind"] == "fixed" and one["collides"]]
    return fixed[0] if len(fixed) == 1 and fixed[0]["shape"] == "box" else None


def sinking(scene, run, _):
    """How deep a corner of a body is below the surface."""
    base = under(scene)
    if base is None:
        return None
    turn = space.rotation(base["rpy_deg"])
    up, top = turn[:, 2], np.array(base["position_m"]) + turn @ [0, 0, base["size_m"][2] / 2]
    deepest = 0.0
    for one in scene["bodies"]:
        if one["kind"] != "dynamic" or not one["collides"]:
            continue
        origin, first, second = (np.array([run[f"{one['name']}.p{place}.{axis}"] for axis in "xyz"]).T for place in range(3))
        height = (origin - top) @ up
        if one["shape"] == "sphere":
            reach = one["radius_m"]
        elif one["shape"] == "box":
            half = np.array(one["size_m"]) / 2
            scale = half.max()
            x, y = (first - origin) / scale, (second - origin) / scale
            reach = sum(np.abs(axes @ up) * size for axes, size in zip((x, y, np.cross(x, y)), half))
        else:
            continue
        deepest = max(deepest, float(np.max(reach - height)))
    return deepest


def cone(scene, run, every_us):
    """By what share friction exceeds its limit, as impulses between two samples, of a single body on a fixed one."""
    base = under(scene)
    moving = [one for one in scene["bodies"] if one["kind"] == "dynamic"]
    touching = scenes.touching(scene)
    if base is None or len(moving) != 1 or scene["joints"] or len(touching) != 1:
        return None
    name, friction = moving[0]["name"], touching[0][2]
    up = space.rotation(base["rpy_deg"])[:, 2]
    velocity = np.array([run[f"{name}.p0.v{axis}"] for axis in "xyz"]).T
    # the first sample has no step before it
    gained = np.diff(velocity[1:], axis=0) - np.array(scene["gravity_m_s2"]) * every_us * 1e-6
    pressed = gained @ up
    along = np.linalg.norm(gained - np.outer(pressed, up), axis=1)
    usual = 9.81 * every_us * 1e-6
    return float(np.max(np.maximum(0.0, along - friction * pressed))) / usual
