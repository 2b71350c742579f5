// What components look like: on the bodies that they belong to, rollers of conveyors, beams of light barriers and curtains, barrels and rods of
// cylinders, motors, grippers; and what stands by itself, as tanks and lamps. They are drawn only. A component whose bodies a
// scenario draws by figures of its own, or never shows, has none.

import { Box3, BoxGeometry, Color, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, Vector3, type Object3D } from "three";
import { DARK_STEEL, HOUSING, PAINT, STEEL, UP, bar, parameter, solid } from "./fitted";
import type { Room } from "./framing";
import type { Component, Session, Vec3 } from "./session";
import { standing } from "./standing";

const BEAM = new Color("#ff4a2e");
const BEAM_CUT = new Color("#ffd23c");

/** A body that components belong to, as it is drawn. */
export interface Carrier {
  readonly node: Object3D;
  /** Its box, in its own frame, m. */
  readonly low: Vector3;
  readonly high: Vector3;
}

/** What moves or shines of a component. */
interface Fitting {
  readonly signals: readonly number[];
  /** The value of a signal, and how much virtual time went by since the last picture, s. */
  readonly show: (value: (signal: number) => number, step_s: number) => void;
}

/** Where the shaft ends of a belt are: the middles of its ends along the way it runs, and how wide it is across. */
export function ends_of(low: Vec3, high: Vec3, way: Vec3): { readonly ends: readonly [Vec3, Vec3]; readonly across: number; readonly radius: number } {
  const along = Math.abs(way[0]) >= Math.abs(way[1]) ? 0 : 1;
  const other = 1 - along;
  const radius = Math.max(0.005, (high[2] - low[2]) / 2);
  const middle: [number, number, number] = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
  const end = (at: number): Vec3 => along === 0 ? [at, middle[1], middle[2]] : [middle[0], at, middle[2]];
  return { ends: [end(low[along] as number), end(high[along] as number)], across: (high[other] as number) - (low[other] as number), radius };
}

/** Along which the beams of a curtain lie beside each other where its scene does not say: upwards, or along x. */
export function along_of(way: Vector3): Vector3 {
  const along = UP.clone().addScaledVector(way, -way.z);
  return along.lengthSq() < 1e-12 ? new Vector3(1, 0, 0) : along.normalize();
}

/** The bodies that a component is on, moves or stands on. */
function bodies_of({ body, place }: Component): readonly string[] {
  return [body, place?.moves ?? null, place?.joint?.parent ?? null].flatMap((one) => one ?? []);
}

/** The bodies that a scenario draws by figures of its own, or never shows. */
export function drawn_otherwise(session: Session): ReadonlySet<string> {
  const found = new Set<string>();
  session.bodies.forEach((body) => {
    let at = body.kind === "figure" ? body.on : null;
    // A figure may be on a figure.
    while (at !== null) {
      const under = session.bodies[at];
      if (under !== undefined && under.kind !== "figure") found.add(under.name);
      at = under?.kind === "figure" ? under.on : null;
    }
  });
  for (const look of session.looks) {
    const isNever = look.when === null && (look.hidden || (look.transparent ?? 0) >= 1);
    for (const body of isNever ? look.bodies : []) found.add(session.bodies[body]?.name ?? "");
  }
  return found;
}

/** What components look like on top of the bodies of a machine. */
export class Fittings {
  private readonly all: Fitting[] = [];
  private readonly values = new Map<number, number>();
  private readonly standing: { readonly name: string; readonly node: Object3D }[] = [];

  /** `carrier` gives a body as it is drawn by its name; nothing of one that is not, or not by itself. */
  constructor(
    private readonly session: Session,
    private readonly scene: Object3D,
    private readonly carrier: (body: string) => Carrier | null,
    private readonly run: (body: string, way_m: number) => void,
  ) {
    const own = drawn_otherwise(session);
    for (const component of session.components) if (!bodies_of(component).some((body) => own.has(body))) this.fit(component);
  }

  /** Where the components are that stand by themselves, by their names. */
  rooms(): readonly (Room & { readonly name: string })[] {
    return this.standing.map(({ name, node }) => {
      const { min, max } = new Box3().setFromObject(node);
      return { name, low: min.toArray(), high: max.toArray() };
    });
  }

  /** The signals that fittings follow. */
  signals(): readonly number[] {
    return this.all.flatMap((one) => one.signals);
  }

  value(signal: number, value: number): void {
    this.values.set(signal, value);
  }

  /** Virtual time has gone on; true if something looks different. */
  advance(step_s: number): boolean {
    for (const one of this.all) one.show((signal) => this.values.get(signal) ?? 0, step_s);
    return this.all.length > 0;
  }

  private pin(component: Component, key: string): number | null {
    const name = component.pins.find(([pin]) => pin === key)?.[1] ?? (key === "sees" ? component.senses : null);
    const signal = this.session.signals.findIndex((one) => one.name === name);
    return signal < 0 ? null : signal;
  }

  private fit(component: Component): void {
    const { place } = component;
    if (place === null) return;
    if (component.kind === "conveyor") this.conveyor(component);
    else if (component.kind === "light_barrier" || component.kind === "laser_distance") this.beam(component);
    else if (component.kind === "light_curtain") this.curtain(component);
    else if (component.kind === "pneumatic_cylinder" || component.kind === "hydraulic_cylinder") this.cylinder(component);
    else if (component.kind === "vacuum_cup" || component.kind === "gripper") this.hand(component);
    else if (place.joint?.turns === true) this.motor(component);
    else if (place.joint === null && place.moves === null) this.stand(component);
  }

  /** What stands by itself, where the scene shows it. */
  private stand(component: Component): void {
    const { place } = component;
    if (place?.point_m == null) return;
    const made = standing(component, this.session.components);
    if (made === null) return;
    made.node.position.set(...place.point_m);
    // A switch or a window looks along its ray.
    if (place.direction !== null) made.node.quaternion.setFromUnitVectors(UP, new Vector3(...place.direction));
    made.node.userData["component"] = component.name;
    this.put(made.node, component.body);
    if (place.direction === null) this.standing.push({ name: component.name, node: made.node });
    const pins = new Map(made.follows.flatMap((key): [string, number][] => {
      const signal = this.pin(component, key);
      return signal === null ? [] : [[key, signal]];
    }));
    const known = (key: string): number | null => {
      const signal = pins.get(key);
      return signal === undefined ? null : this.values.get(signal) ?? null;
    };
    this.all.push({ signals: [...pins.values()], show: () => made.show(known) });
  }

  /** Rollers at the ends of the belt and rails along it; its surface runs. */
  private conveyor(component: Component): void {
    const { place } = component;
    const name = place?.moves ?? null;
    const belt = name === null ? null : this.carrier(name);
    if (belt === null || name === null || place?.direction == null) return;
    const direction = new Vector3(...place.direction).applyQuaternion(belt.node.quaternion.clone().invert());
    const { ends, across, radius } = ends_of(belt.low.toArray(), belt.high.toArray(), direction.toArray());
    const side = new Vector3(0, 0, 1).cross(direction).normalize();
    const rollers = ends.map((end) => {
      const roller = new Group();
      const shaft = bar(side.clone().multiplyScalar(-across / 2), side.clone().multiplyScalar(across / 2), radius, DARK_STEEL);
      const stub = bar(side.clone().multiplyScalar(-across / 2 - radius), side.clone().multiplyScalar(across / 2 + radius), radius * 0.45, STEEL);
      // A notch, so that one sees it turn.
      const notch = solid(new BoxGeometry(radius * 0.5, radius * 0.5, radius * 0.5), HOUSING);
      notch.position.copy(side).multiplyScalar(across / 2 + radius * 0.3).add(new Vector3(0, 0, radius * 0.6));
      roller.add(shaft, stub, notch);
      roller.position.set(...end);
      belt.node.add(roller);
      return roller;
    });
    const [from, to] = ends.map((end) => new Vector3(...end));
    for (const way of [-1, 1]) {
      if (from === undefined || to === undefined) break;
      const rail = solid(new BoxGeometry(1, 1, 1), PAINT);
      const along = to.clone().sub(from);
      const isAlongX = Math.abs(along.x) > Math.abs(along.y);
      rail.scale.set(isAlongX ? along.length() : radius * 0.4, isAlongX ? radius * 0.4 : along.length(), radius * 1.5);
      rail.position.copy(from).add(to).multiplyScalar(0.5).addScaledVector(side, way * (across / 2 + radius * 0.25)).add(new Vector3(0, 0, -radius * 0.2));
      belt.node.add(rail);
    }
    const [velocity, running, on] = [this.pin(component, "velocity_m_s"), this.pin(component, "running"), this.pin(component, "run")];
    const rated = parameter(component, "speed") ?? 0.3;
    let way_m = 0;
    this.all.push({
      signals: [velocity, running, on].flatMap((signal) => signal ?? []),
      show: (value, step_s) => {
        const speed = velocity !== null ? value(velocity) : (running ?? on) !== null && value(running ?? on ?? 0) !== 0 ? rated : 0;
        if (speed === 0 || step_s === 0) return;
        way_m += speed * step_s;
        this.run(name, way_m);
        for (const roller of rollers) roller.quaternion.setFromAxisAngle(side, (way_m / radius) % (2 * Math.PI));
      },
    });
  }

  /** Two housings and the beam between them, which is another while something is in it. */
  private beam(component: Component): void {
    const { place } = component;
    if (place?.point_m == null || place.direction === null) return;
    const range = parameter(component, "range") ?? 1;
    const [from, way] = [new Vector3(...place.point_m), new Vector3(...place.direction)];
    const to = from.clone().addScaledVector(way, range);
    const size = Math.min(0.05, Math.max(0.008, range * 0.06));
    const group = new Group();
    const light = new MeshBasicMaterial({ color: BEAM, transparent: true, opacity: 0.75 });
    const ray = new Mesh(new CylinderGeometry(size * 0.12, size * 0.12, range, 8).rotateX(Math.PI / 2), light);
    ray.position.copy(from).addScaledVector(way, range / 2);
    ray.quaternion.setFromUnitVectors(UP, way);
    const ends = component.kind === "light_barrier" ? [-1, 1] : [-1];
    for (const end of ends) {
      const housing = solid(new BoxGeometry(size, size, size * 1.4), HOUSING);
      housing.position.copy(end < 0 ? from : to).addScaledVector(way, end * size * 0.7);
      housing.quaternion.setFromUnitVectors(UP, way);
      group.add(housing);
    }
    group.add(ray);
    this.put(group, component.body);
    const sees = this.pin(component, "sees");
    if (sees === null) return;
    this.all.push({ signals: [sees], show: (value) => void light.color.copy(value(sees) === 0 ? BEAM : BEAM_CUT) });
  }

  /** Two posts and the beams between them, which are another while one of them is dark. */
  private curtain(component: Component): void {
    const { place } = component;
    if (place?.point_m == null || place.direction === null) return;
    const { range, pitch, count } = { range: parameter(component, "range") ?? 1, pitch: parameter(component, "pitch") ?? 0.02, count: parameter(component, "beams") ?? 16 };
    const [from, way] = [new Vector3(...place.point_m), new Vector3(...place.direction)];
    const along = place.along == null ? along_of(way) : new Vector3(...place.along);
    const size = Math.min(0.06, Math.max(0.01, pitch * 1.5));
    const group = new Group();
    const light = new MeshBasicMaterial({ color: BEAM, transparent: true, opacity: 0.55 });
    const middle = from.clone().addScaledVector(along, (pitch * (count - 1)) / 2);
    for (const [at, side] of [[0, -1], [range, 1]] as const) {
      const post = solid(new BoxGeometry(size, size, pitch * count + size), HOUSING);
      post.position.copy(middle).addScaledVector(way, at + side * size * 0.5);
      post.quaternion.setFromUnitVectors(UP, along);
      group.add(post);
    }
    for (let beam = 0; beam < count; beam += 1) {
      const ray = new Mesh(new CylinderGeometry(size * 0.06, size * 0.06, range, 6).rotateX(Math.PI / 2), light);
      ray.position.copy(from).addScaledVector(along, beam * pitch).addScaledVector(way, range / 2);
      ray.quaternion.setFromUnitVectors(UP, way);
      group.add(ray);
    }
    this.put(group, component.body);
    const free = this.pin(component, "ossd_1") ?? this.pin(component, "ossd_2");
    if (free === null) return;
    this.all.push({ signals: [free], show: (value) => void light.color.copy(value(free) === 0 ? BEAM_CUT : BEAM) });
  }

  /** A barrel where the joint's parent is, and a rod from it to what it moves. */
  private cylinder(component: Component): void {
    const { place } = component;
    const { joint } = place ?? { joint: null };
    const child = place?.moves == null ? null : this.carrier(place.moves);
    if (joint === null || joint.turns || child === null) return;
    const [back, ahead] = [joint.back ?? 0, joint.ahead ?? parameter(component, "stroke") ?? 0.2];
    const stroke = ahead - back;
    if (!(stroke > 0) || !Number.isFinite(stroke)) return;
    const axis = new Vector3(...joint.axis);
    child.node.updateWorldMatrix(true, false);
    const turned = child.node.getWorldQuaternion(new Quaternion());
    const size = child.high.clone().sub(child.low);
    const middle = child.node.localToWorld(child.high.clone().add(child.low).multiplyScalar(0.5));
    const along = axis.clone().applyQuaternion(turned.clone().invert());
    const half = (Math.abs(along.x) * size.x + Math.abs(along.y) * size.y + Math.abs(along.z) * size.z) / 2;
    const lateral = [size.x, size.y, size.z].filter((_, at) => Math.abs(along.getComponent(at)) < 0.7);
    const radius = Math.min(stroke * 0.25, Math.max(0.008, Math.min(...lateral, stroke) * 0.28));
    const rear = middle.clone().addScaledVector(axis, -half);
    // Where the rear of what it moves is when the rod is in.
    const front = rear.clone().addScaledVector(axis, back - radius * 0.5);
    const barrel = new Group();
    barrel.add(bar(front.clone().addScaledVector(axis, -stroke - radius * 2), front, radius, STEEL));
    for (const [at, length] of [[0, radius * 0.7], [-stroke - radius * 2, radius * 0.7]] as const) {
      barrel.add(bar(front.clone().addScaledVector(axis, at - length / 2), front.clone().addScaledVector(axis, at + length / 2), radius * 1.15, DARK_STEEL));
    }
    this.put(barrel, joint.parent);
    const rod = new Group().add(bar(rear.clone().addScaledVector(axis, -stroke - radius), rear, radius * 0.38, "#dfe4e7"));
    this.scene.add(rod);
    child.node.attach(rod);
  }

  /** A palm with two fingers, or a cup. */
  private hand(component: Component): void {
    const { place } = component;
    if (place?.point_m == null) return;
    const carrier = component.body === null ? null : this.carrier(component.body);
    const size = Math.min(0.15, Math.max(0.015, carrier === null ? 0.05 : 0.25 * carrier.high.clone().sub(carrier.low).length()));
    const way = new Vector3(...(place.direction ?? [0, 0, -1]));
    const hand = new Group();
    if (component.kind === "vacuum_cup") {
      const cup = solid(new ConeGeometry(size * 0.5, size * 0.6, 24, 1, true).rotateX(Math.PI / 2), "#30363a");
      cup.position.z = -size * 0.3;
      cup.rotation.x = Math.PI;
      hand.add(cup, bar(new Vector3(0, 0, -size * 1.4), new Vector3(0, 0, -size * 0.5), size * 0.15, STEEL));
    } else {
      const palm = solid(new BoxGeometry(size, size * 0.5, size * 0.35), PAINT);
      palm.position.z = -size * 0.8;
      hand.add(palm);
      for (const side of [-1, 1]) {
        const finger = solid(new BoxGeometry(size * 0.14, size * 0.35, size * 0.75), STEEL);
        finger.position.set(side * size * 0.4, 0, -size * 0.3);
        hand.add(finger);
      }
    }
    hand.quaternion.setFromUnitVectors(UP, way);
    hand.position.set(...place.point_m);
    this.put(hand, component.body);
  }

  /** A motor on the axis that it turns, below or behind what turns. */
  private motor(component: Component): void {
    const { joint, moves } = component.place ?? { joint: null, moves: null };
    const child = moves === null ? null : this.carrier(moves);
    if (joint === null || child === null) return;
    const size = child.high.clone().sub(child.low);
    const axis = new Vector3(...joint.axis);
    child.node.updateWorldMatrix(true, false);
    const along = axis.clone().applyQuaternion(child.node.getWorldQuaternion(new Quaternion()).invert());
    const half = (Math.abs(along.x) * size.x + Math.abs(along.y) * size.y + Math.abs(along.z) * size.z) / 2;
    const radius = Math.max(0.01, 0.12 * Math.max(size.x, size.y, size.z) * 0.5);
    const way = axis.z > 0.5 ? axis.clone().negate() : axis.clone();
    const middle = child.node.localToWorld(child.high.clone().add(child.low).multiplyScalar(0.5));
    const anchor = new Vector3(...joint.anchor_m);
    // On the axis, at the height of the middle of what it turns.
    const at = anchor.clone().addScaledVector(axis, middle.clone().sub(anchor).dot(axis)).addScaledVector(way, half);
    const motor = new Group().add(
      bar(at, at.clone().addScaledVector(way, radius * 0.6), radius * 0.4, STEEL),
      bar(at.clone().addScaledVector(way, radius * 0.6), at.clone().addScaledVector(way, radius * 2.8), radius, PAINT));
    this.put(motor, joint.parent);
  }

  /** Puts a group, which is in the world, into the frame of a body, or leaves it in the world's. */
  private put(group: Group, body: string | null): void {
    this.scene.add(group);
    const carrier = body === null ? null : this.carrier(body);
    if (carrier === null) return;
    carrier.node.updateWorldMatrix(true, false);
    carrier.node.attach(group);
  }
}
