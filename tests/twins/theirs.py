"""The scene for MuJoCo: MJCF with the same numbers, and a run of it.

Contacts, stops, dry friction, loops and gears are soft in MuJoCo. Here all have the time constant `SOFT` times the step and the
largest impedance, so that their softness goes to zero with the step, and is part of the error that halving the step shows.
"""

import mujoco
import numpy as np

import scene as scenes
import space

# Time constant of all constraints, in steps: MuJoCo wants at least 2.
SOFT = 4
# Damping of stops and contacts, by the critical one: at 1 a step leaves something of an impact, so that it bounces.
DAMPED = 2
# The same of friction in contacts, per root of a step: what slides at v is lifted off at 2 mu v step/constant, so this must be
# long beside a step, and go to zero with it.
SLIDING = 1.0
IMPEDANCE = "0.9999 0.9999 0.001 0.5 2"
# Inertia of what follows a path: others move it by less than a millionth of what they do to 1 kg or 1 kg m2.
DRIVEN = 1e7


class Unfit(Exception):
    """MuJoCo does not take a scene, or does not come through it."""


def numbers(given):
    return " ".join(repr(float(one)) for one in given)


class Writer:
    """MJCF of a scene at one step."""

    def __init__(self, scene, step_us):
        self.scene = scene
        self.step = step_us * 1e-6
        reference = f"{SOFT * self.step!r} 1"
        self.stopping = f"{SOFT * self.step!r} {DAMPED}"
        self.soft = f'solref="{reference}" solimp="{IMPEDANCE}"'
        self.of_joint = (f'solreflimit="{self.stopping}" solimplimit="{IMPEDANCE}" '
                         f'solreffriction="{reference}" solimpfriction="{IMPEDANCE}"')
        self.of_contact = f'solref="{self.stopping}" solimp="{IMPEDANCE}" solreffriction="{SLIDING * self.step ** 0.5!r} 1"'
        self.belts = {one["body"]: one for one in scene["belts"]}

    def text(self):
        roots = [one for one in self.scene["bodies"] if self.parent(one) in (None, "ground")]
        return "\n".join([
            "<mujoco>", '<compiler angle="radian" autolimits="true" boundmass="0" boundinertia="0"/>',
            f'<option timestep="{self.step!r}" gravity="{numbers(self.scene["gravity_m_s2"])}" integrator="implicitfast" '
            'cone="elliptic" solver="Newton" tolerance="1e-12" iterations="100" ls_iterations="100">'
            '<flag multiccd="enable"/></option>',
            "<worldbody>", *(self.body(one, (np.eye(3), np.zeros(3))) for one in roots), "</worldbody>",
            *self.contacts(), *self.equalities(), *self.actuators(), "</mujoco>", ""])

    def holder(self, one):
        """The joint that this body hangs on in the tree."""
        return next((joint for joint in self.scene["joints"] if joint["child"] == one["name"] and not joint["loop"]), None)

    def parent(self, one):
        joint = self.holder(one)
        return joint and joint["parent"]

    def body(self, one, outer):
        turn, position = space.rotation(one["rpy_deg"]), np.array(one["position_m"])
        local = (outer[0].T @ turn, outer[0].T @ (position - outer[1]))
        lines = [f'<body name="{one["name"]}" pos="{numbers(local[1])}" quat="{numbers(space.quaternion(local[0]))}">']
        joint = self.holder(one)
        if joint:
            lines += self.joint(joint, turn, position)
        elif one["name"] in self.belts:
            direction = turn.T @ np.array(self.belts[one["name"]]["direction"])
            lines.append(f'<joint name="belt_{one["name"]}" type="slide" axis="{numbers(direction)}" armature="{DRIVEN}"/>')
        elif one["kind"] == "dynamic":
            lines.append(f'<freejoint name="free_{one["name"]}"/>')
        lines.append(self.geom(one))
        if one["kind"] == "dynamic":
            for place, point in enumerate(space.marks(one)):
                lines.append(f'<site name="{one["name"]}.p{place}" pos="{numbers(turn.T @ (point - position))}"/>')
        inner = [child for child in self.scene["bodies"] if self.parent(child) == one["name"]]
        lines += [self.body(child, (turn, position)) for child in inner]
        return "\n".join([*lines, "</body>"])

    def joint(self, one, turn, position):
        name, place = one["name"], ""
        if "anchor_m" in one:
            place = f'pos="{numbers(turn.T @ (np.array(one["anchor_m"]) - position))}"'
        if one["kind"] == "ball":
            return [f'<joint name="{name}" type="ball" {place}/>']
        axis = f'axis="{numbers(turn.T @ np.array(one["axis"]))}"'
        if one["kind"] == "slot":
            slide = f'axis="{numbers(turn.T @ np.array(one["slide"]))}"'
            return [f'<joint name="{name}" type="slide" {slide} {self.coordinate(one)}/>',
                    f'<joint name="{name}_turn" type="hinge" {axis} {place}/>']
        kind = "slide" if one["kind"] == "prismatic" else "hinge"
        return [f'<joint name="{name}" type="{kind}" {axis} {place} {self.coordinate(one)}/>']

    def coordinate(self, one):
        keys = [f'ref="{one["initial"]!r}"', self.of_joint]
        if one["lower"] is not None or one["upper"] is not None:
            ends = [-1e4 if one["lower"] is None else one["lower"], 1e4 if one["upper"] is None else one["upper"]]
            keys.append(f'range="{numbers(ends)}"')
        fit = scenes.of_joint(self.scene, "fittings", one["name"]) or {}
        keys.append(f'stiffness="{fit.get("spring", 0.0)!r}" springref="{fit.get("rest", 0.0)!r}" '
                    f'damping="{fit.get("damping", 0.0)!r}" frictionloss="{fit.get("friction", 0.0) + fit.get("brake", 0.0)!r}"')
        if scenes.of_joint(self.scene, "turntables", one["name"]):
            keys.append(f'armature="{DRIVEN}"')
        return " ".join(keys)

    def geom(self, one):
        shape = one["shape"]
        mass = f'mass="{one.get("mass_kg", 1.0)!r}"'
        colour = f'<geom name="{one["name"]}" contype="0" conaffinity="0" {mass}'
        if one.get("floor"):
            # its upper face, without an edge
            return f'{colour} type="plane" size="10 10 1" pos="0 0 {one["size_m"][2] / 2!r}"/>'
        if shape == "box":
            return f'{colour} type="box" size="{numbers(np.array(one["size_m"]) / 2)}"/>'
        if shape == "sphere":
            return f'{colour} type="sphere" size="{one["radius_m"]!r}"/>'
        return f'{colour} type="{shape}" size="{one["radius_m"]!r} {one["length_m"] / 2!r}"/>'

    def contacts(self):
        lines = [f'<pair geom1="{one["name"]}" geom2="{other["name"]}" condim="3" friction="{friction!r} {friction!r} 0 0 0" '
                 f'{self.of_contact}/>' for one, other, friction in scenes.touching(self.scene)]
        return ["<contact>", *lines, "</contact>"] if lines else []

    def equalities(self):
        """Gears and loops. A gear with two leaders, or with play, is a tendon."""
        tendons, equal = [], []
        for one in self.scene["couplings"]:
            name = one["name"]
            initial = {joint: scenes.named(self.scene, "joints", joint)["initial"] for joint in [one["joint"], *one["of"]]}
            length = initial[one["joint"]] - sum(share * initial[of] for share, of in zip(one["ratio"], one["of"]))
            if len(one["of"]) == 1 and not one["backlash"]:
                equal.append(f'<joint joint1="{one["joint"]}" joint2="{one["of"][0]}" '
                             f'polycoef="0 {one["ratio"][0]!r} 0 0 0" {self.soft}/>')
                continue
            play = one["backlash"] / 2
            limit = (f'range="{length - play!r} {length + play!r}" '
                     f'solreflimit="{self.stopping}" solimplimit="{IMPEDANCE}"' if play else "")
            shares = [f'<joint joint="{one["joint"]}" coef="1"/>']
            shares += [f'<joint joint="{of}" coef="{-share!r}"/>' for share, of in zip(one["ratio"], one["of"])]
            tendons.append(f'<fixed name="{name}" {limit}>{"".join(shares)}</fixed>')
            if not play:
                equal.append(f'<tendon tendon1="{name}" polycoef="0 1 0 0 0" {self.soft}/>')
        for one in self.scene["joints"]:
            if one["loop"]:
                child = scenes.named(self.scene, "bodies", one["child"])
                turn = space.rotation(child["rpy_deg"])
                place = turn.T @ (np.array(one["anchor_m"]) - np.array(child["position_m"]))
                other = "world" if one["parent"] == "ground" else one["parent"]
                equal.append(f'<connect body1="{one["child"]}" body2="{other}" anchor="{numbers(place)}" {self.soft}/>')
        return [*(["<tendon>", *tendons, "</tendon>"] if tendons else []),
                *(["<equality>", *equal, "</equality>"] if equal else [])]

    def actuators(self):
        """Each has 1 for its control, from the start on."""
        lines = []
        for one in self.scene["drives"]:
            lag = f'dyntype="filterexact" dynprm="{one["lag_s"]!r}"' if one["lag_s"] else ""
            lines.append(f'<general joint="{one["joint"]}" gainprm="{one["effort"]!r}" {lag}/>')
        for one in self.scene["fittings"]:
            if one.get("balance"):
                lines.append(f'<general joint="{one["joint"]}" gainprm="{one["balance"]!r}"/>')
        return ["<actuator>", *lines, "</actuator>"] if lines else []


def mjcf(scene, step_us):
    return Writer(scene, step_us).text()


def paths(scene, model):
    """Degrees of freedom that follow a ramp: their place, acceleration and the time at which they have their speed."""
    found = []
    for one in scene["belts"]:
        found.append((model.joint(f"belt_{one['body']}").dofadr[0], one["acceleration"], one["speed"] / one["acceleration"]))
    for one in scene["turntables"]:
        found.append((model.joint(one["joint"]).dofadr[0], one["acceleration"], one["speed"] / one["acceleration"]))
    return found


def started(scene, model):
    data = mujoco.MjData(model)
    for one in scenes.loose(scene):
        address = model.joint(f"free_{one['name']}").dofadr[0]
        data.qvel[address:address + 3] = one["velocity_m_s"]
    data.ctrl[:] = 1.0
    return data


def run(scene, step_us, every_us):
    """Coordinates and points at every multiple of `every_us`."""
    try:
        model = mujoco.MjModel.from_xml_string(mjcf(scene, step_us))
    except ValueError as refused:
        raise Unfit(str(refused)) from refused
    data = started(scene, model)
    followed = paths(scene, model)
    joints = [(f"{one['name']}.q", model.joint(one["name"]).qposadr[0]) for one in scene["joints"]
              if scenes.has_coordinate(one) and not one["loop"]]
    sites = [(model.site(number).name, number) for number in range(model.nsite)]
    rows = []
    steps = every_us // step_us
    for sample in range(scene["until_ms"] * 1000 // every_us + 1):
        if sample:
            advance(model, data, followed, steps, step_us)
        mujoco.mj_kinematics(model, data)
        rows.append([*(data.qpos[place] for _, place in joints), *(x for _, site in sites for x in data.site_xpos[site])])
    if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number or not np.all(np.isfinite(rows)):
        raise Unfit(f"unstable at {step_us} us")
    names = [name for name, _ in joints] + [f"{name}.{axis}" for name, _ in sites for axis in "xyz"]
    return dict(zip(names, np.array(rows).T))


def advance(model, data, followed, steps, step_us):
    """Steps, with the force of what follows a ramp, which is whole steps long in parts of `steps`."""
    if not followed:
        mujoco.mj_step(model, data, steps)
        return
    for _ in range(steps):
        for dof, acceleration, end in followed:
            left = end - data.time
            share = min(1.0, max(0.0, left / (step_us * 1e-6)))
            data.qfrc_applied[dof] = DRIVEN * acceleration * share
        mujoco.mj_step(model, data)
