// What components look like that stand by themselves: tanks with their level, lamps, push buttons, emergency stops, heaters,
// hydraulic units, switches that look along a ray, stack lights, key switches, two-hand stations, readers, heads, scales. Each stands on its own origin, with z upwards or along its ray.

import { BoxGeometry, CircleGeometry, Color, CylinderGeometry, DoubleSide, Group, Mesh, MeshLambertMaterial, SphereGeometry, Vector3, type BufferGeometry } from "three";
import { DARK_STEEL, HOUSING, PAINT, STEEL, bar, parameter, solid } from "./fitted";
import { glow_of } from "./heat";
import type { Component } from "./session";

/** A shape, and how it follows the inputs and outputs of its component. */
export interface Standing {
  readonly node: Group;
  /** The keys of what it follows. */
  readonly follows: readonly string[];
  /** The value of a key; nothing of one that has no signal, or none yet. */
  readonly show: (value: (key: string) => number | null) => void;
}

const LIQUID = "#3b82c4";
const GLASS = "#9fb6c6";
const RED = "#d8262c";
const YELLOW = "#f2c230";
const BLACK = new Color("#000000");
/** The module of a lamp, as of a stack light: its radius and its height, m. */
const LAMP_M = [0.035, 0.07] as const;
/** The pole below the lowest one, m. */
const POLE_M = 0.3;

const at = (x: number, y: number, z: number): Vector3 => new Vector3(x, y, z);

function placed(geometry: BufferGeometry, colour: string, position: Vector3): Mesh<BufferGeometry, MeshLambertMaterial> {
  const mesh = solid(geometry, colour) as Mesh<BufferGeometry, MeshLambertMaterial>;
  mesh.position.copy(position);
  return mesh;
}

const upright = (radius: number, height: number, sides = 32): BufferGeometry => new CylinderGeometry(radius, radius, height, sides).rotateX(Math.PI / 2);

/** The shape of a component among all; nothing of a kind that is nowhere. */
export function standing(component: Component, all: readonly Component[]): Standing | null {
  switch (component.kind) {
    case "tank":
      return tank(component);
    case "lamp":
      return lamp(component, all);
    case "stack_light":
      return stack();
    case "key_switch":
      return key();
    case "two_hand_station":
      return hands();
    case "barcode_reader":
      return reader();
    case "rfid_head":
      return head();
    case "weighing_cell":
      return scale();
    case "push_button":
      return button(component);
    case "emergency_stop":
      return stop();
    case "heater":
      return heater(component);
    case "hydraulic_unit":
      return unit();
    case "inductive_sensor":
    case "capacitive_sensor":
      return ray_switch(component);
    default:
      return null;
  }
}

/** A glass vessel with its liquid, a pump above and a valve below. */
function tank(component: Component): Standing {
  const height = parameter(component, "height") ?? 2;
  const radius = Math.sqrt((parameter(component, "area") ?? 1) / Math.PI);
  const edge = Math.min(0.06, radius * 0.12);
  const node = new Group();
  const wall = placed(new CylinderGeometry(radius, radius, height, 48, 1, true).rotateX(Math.PI / 2), GLASS, at(0, 0, height / 2));
  wall.material.side = DoubleSide;
  wall.material.transparent = true;
  wall.material.opacity = 0.28;
  wall.material.depthWrite = false;
  wall.castShadow = false;
  // It grows from the bottom.
  const body = new CylinderGeometry(radius * 0.97, radius * 0.97, height, 48).rotateX(Math.PI / 2).translate(0, 0, height / 2);
  const liquid = solid(body, LIQUID);
  liquid.name = "liquid";
  const surface = new Mesh(new CircleGeometry(radius * 0.97, 48), new MeshLambertMaterial({ color: "#79b2e4" }));
  node.add(wall, liquid, surface);
  for (const z of [0, height]) node.add(placed(upright(radius + edge / 2, edge, 48), STEEL, at(0, 0, z === 0 ? -edge / 2 : z)));
  for (const turn of [0.25, 0.75, 1.25, 1.75]) {
    const [x, y] = [Math.cos(turn * Math.PI) * (radius + edge), Math.sin(turn * Math.PI) * (radius + edge)];
    node.add(bar(at(x, y, -edge), at(x, y, height + edge / 2), edge * 0.35, DARK_STEEL));
  }
  const pipe = edge * 0.8;
  const x = radius + edge * 4;
  node.add(
    bar(at(x, 0, 0), at(x, 0, height + edge * 3), pipe, STEEL), bar(at(x + pipe, 0, height + edge * 3), at(radius * 0.5, 0, height + edge * 3), pipe, STEEL),
    bar(at(radius * 0.5, 0, height + edge * 3), at(radius * 0.5, 0, height), pipe, STEEL), placed(upright(pipe * 3, pipe * 6), PAINT, at(x, 0, pipe * 3)),
    bar(at(-radius, 0, edge * 2), at(-radius - edge * 5, 0, edge * 2), pipe, STEEL), placed(new BoxGeometry(pipe * 3, pipe * 3, pipe * 3), HOUSING, at(-radius - edge * 3, 0, edge * 2)));
  const show = (level_m: number): void => {
    const share = Math.min(1, Math.max(0, level_m / height));
    // What has no height at all cannot be lit.
    liquid.scale.z = Math.max(1e-4, share);
    liquid.visible = surface.visible = share > 0;
    surface.position.z = share * height + 0.001;
  };
  show(parameter(component, "initial") ?? 0);
  return {
    node, follows: ["level_m"],
    show: (value) => {
      const level_m = value("level_m");
      if (level_m !== null) show(level_m);
    },
  };
}

/** The colour of a lamp, as its name says. */
export function lamp_colour(name: string): string {
  if (/red|rot|alarm|fault|error|stop|stör/i.test(name)) return RED;
  if (/green|grün|run|ready|ok\b/i.test(name)) return "#2fae4d";
  if (/yellow|gelb|amber|orange|warn/i.test(name)) return "#f0a818";
  return /blue|blau/i.test(name) ? "#2f7fd8" : "#e9edf0";
}

/** A module of a stack light, on a pole if no other is below it. */
function lamp(component: Component, all: readonly Component[]): Standing {
  const [radius, height] = LAMP_M;
  const node = new Group();
  const here = component.place?.point_m ?? [0, 0, 0];
  const isOnAnother = all.some((other) => {
    const there = other.kind === "lamp" && other !== component ? other.place?.point_m ?? null : null;
    return there !== null && Math.hypot(here[0] - there[0], here[1] - there[1]) < radius && here[2] - there[2] > 0 && here[2] - there[2] < 1.5 * height;
  });
  const lens = placed(upright(radius, height * 0.85), lamp_colour(component.name), at(0, 0, height / 2));
  const [off, on] = [lens.material.color.clone().lerp(new Color("#30363a"), 0.55), lens.material.color.clone()];
  node.add(lens, placed(upright(radius * 1.08, height * 0.1), DARK_STEEL, at(0, 0, 0)), placed(upright(radius * 1.08, height * 0.1), DARK_STEEL, at(0, 0, height)));
  if (!isOnAnother) node.add(bar(at(0, 0, -POLE_M), at(0, 0, 0), radius * 0.3, STEEL), placed(upright(radius * 1.3, 0.012), DARK_STEEL, at(0, 0, -POLE_M)));
  const show = (share: number): void => {
    lens.material.color.copy(off).lerp(on, share);
    lens.material.emissive.copy(on);
    lens.material.emissiveIntensity = 0.9 * share;
  };
  show(0);
  return { node, follows: ["brightness", "lit", "on"], show: (value) => show(Math.min(1, Math.max(0, value("brightness") ?? value("lit") ?? value("on") ?? 0))) };
}

/** The tiers of a stack light from the bottom up, by the keys of what is seen of them. */
const TIERS = [["white", "#e9edf0"], ["blue", "#2f7fd8"], ["green", "#2fae4d"], ["amber", "#f0a818"], ["red", RED]] as const;

/** Five tiers on a pole, and a buzzer on top, which is lighter while it sounds. */
function stack(): Standing {
  const [radius, height] = LAMP_M;
  const node = new Group().add(bar(at(0, 0, -POLE_M), at(0, 0, 0), radius * 0.3, STEEL), placed(upright(radius * 1.3, 0.012), DARK_STEEL, at(0, 0, -POLE_M)));
  const tiers = TIERS.map(([key, colour], tier) => {
    const lens = placed(upright(radius, height * 0.85), colour, at(0, 0, height * (tier + 0.5)));
    const [off, on] = [lens.material.color.clone().lerp(new Color("#30363a"), 0.55), lens.material.color.clone()];
    node.add(lens, placed(upright(radius * 1.08, height * 0.1), DARK_STEEL, at(0, 0, height * tier)));
    return { key, lens, off, on };
  });
  const buzzer = placed(upright(radius * 1.08, height * 0.4), DARK_STEEL, at(0, 0, height * (TIERS.length + 0.2)));
  node.add(buzzer);
  const show = (value: (key: string) => number | null): void => {
    for (const { key, lens, off, on } of tiers) {
      const isLit = (value(`${key}_lit`) ?? value(key) ?? 0) !== 0;
      lens.material.color.copy(isLit ? on : off);
      lens.material.emissive.copy(isLit ? on : BLACK);
      lens.material.emissiveIntensity = 0.9;
    }
    buzzer.material.color.set((value("sounding") ?? value("buzzer") ?? 0) === 0 ? DARK_STEEL : HOUSING);
  };
  show(() => null);
  return { node, follows: [...TIERS.flatMap(([key]) => [`${key}_lit`, key]), "sounding", "buzzer"], show };
}

/** A box with a lock, whose key stands in its position. */
function key(): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.08, 0.08, 0.05), "#8b949a", at(0, 0, 0.025)), placed(upright(0.03, 0.008), STEEL, at(0, 0, 0.054)));
  const bow = placed(new BoxGeometry(0.008, 0.045, 0.03), DARK_STEEL, at(0, 0, 0.072));
  node.add(bow);
  return {
    node, follows: ["position", "at_0", "at_1", "at_2"],
    show: (value) => {
      const contact = [0, 1, 2].find((one) => (value(`at_${one}`) ?? 0) !== 0);
      bow.rotation.z = -(Math.PI / 4) * (contact ?? value("position") ?? 0);
    },
  };
}

/** A box with two buttons, each in a collar. */
function hands(): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.5, 0.14, 0.1), YELLOW, at(0, 0, 0.05)));
  const caps = [["left", -0.19], ["right", 0.19]] as const;
  const shown = caps.map(([side, x]) => {
    const cap = placed(upright(0.035, 0.03), "#30363a", at(x, 0, 0.115));
    node.add(cap, placed(upright(0.05, 0.02), DARK_STEEL, at(x, 0, 0.1)));
    return { side, cap };
  });
  return {
    node, follows: ["left_make", "right_make", "left", "right"],
    show: (value) => {
      for (const { side, cap } of shown) cap.position.z = (value(`${side}_make`) ?? value(side) ?? 0) === 0 ? 0.115 : 0.105;
    },
  };
}

/** A housing with a light, which has one of two colours by what a signal says, or none. */
function housing(node: Group, spot: Vector3, follows: readonly string[], colour: (value: (key: string) => number) => string | null): Standing {
  const light = placed(upright(0.008, 0.006), "#3d4449", spot);
  node.add(light);
  return { node, follows, show: (value) => void light.material.color.set(colour((key) => value(key) ?? 0) ?? "#3d4449") };
}

/** A housing with a red window. */
function reader(): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.07, 0.06, 0.09), HOUSING, at(0, 0, 0)), placed(new BoxGeometry(0.05, 0.045, 0.004), "#7a1518", at(0, 0, -0.046)));
  return housing(node, at(0, 0, 0.047), ["good", "no_read"], (value) => value("good") !== 0 ? "#2fae4d" : value("no_read") !== 0 ? RED : null);
}

/** A flat housing with its aerial in front. */
function head(): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.09, 0.09, 0.035), DARK_STEEL, at(0, 0, 0)), placed(new BoxGeometry(0.08, 0.08, 0.006), "#2f6f9f", at(0, 0, -0.02)));
  return housing(node, at(0.03, 0.03, 0.02), ["present", "error"], (value) => value("error") !== 0 ? RED : value("present") !== 0 ? "#2fae4d" : null);
}

/** The indicator of a scale on a stand. */
function scale(): Standing {
  const node = new Group().add(
    bar(at(0, 0, -POLE_M), at(0, 0, 0), 0.012, STEEL), placed(upright(0.05, 0.012), DARK_STEEL, at(0, 0, -POLE_M)),
    placed(new BoxGeometry(0.2, 0.05, 0.13), "#8b949a", at(0, 0, 0.065)), placed(new BoxGeometry(0.15, 0.004, 0.05), "#1f3a2a", at(0, -0.027, 0.085)));
  return housing(node, at(0.085, 0, 0.133), ["stable", "overload"], (value) => value("overload") !== 0 ? RED : value("stable") !== 0 ? "#2fae4d" : null);
}

/** A box with a cap that goes in. */
function button(component: Component): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.08, 0.08, 0.05), "#8b949a", at(0, 0, 0.025)), placed(upright(0.03, 0.008), STEEL, at(0, 0, 0.054)));
  const name = lamp_colour(component.name);
  const cap = placed(upright(0.024, 0.02), /start/i.test(component.name) ? "#2fae4d" : name, at(0, 0, 0.065));
  node.add(cap);
  return {
    node, follows: ["make", "break_contact", "press"],
    show: (value) => {
      const isOpen = value("break_contact");
      const isIn = (value("make") ?? value("press") ?? (isOpen === null ? 0 : 1 - isOpen)) !== 0;
      cap.position.z = isIn ? 0.057 : 0.065;
    },
  };
}

/** A yellow box with a red mushroom. */
function stop(): Standing {
  const node = new Group().add(placed(new BoxGeometry(0.09, 0.09, 0.06), YELLOW, at(0, 0, 0.03)), placed(upright(0.014, 0.03), DARK_STEEL, at(0, 0, 0.07)));
  const head = placed(new SphereGeometry(0.034, 28, 12, 0, 2 * Math.PI, 0, Math.PI / 2).rotateX(Math.PI / 2), RED, at(0, 0, 0.08));
  node.add(head);
  return {
    node, follows: ["channel_a", "channel_b", "hit"],
    show: (value) => {
      const [a, b] = [value("channel_a"), value("channel_b")];
      const isHit = a === null && b === null ? (value("hit") ?? 0) !== 0 : a === 0 || b === 0;
      head.position.z = isHit ? 0.066 : 0.08;
    },
  };
}

/** A block with fins, which glows when it is hot. */
function heater(component: Component): Standing {
  const node = new Group();
  const block = placed(new BoxGeometry(0.3, 0.16, 0.14), STEEL, at(0, 0, 0.11));
  node.add(block);
  for (let fin = -2; fin <= 2; fin += 1) node.add(placed(new BoxGeometry(0.012, 0.2, 0.17), DARK_STEEL, at(fin * 0.06, 0, 0.11)));
  for (const x of [-0.11, 0.11]) node.add(placed(new BoxGeometry(0.03, 0.16, 0.03), DARK_STEEL, at(x, 0, 0.015)));
  const show = (degc: number): void => {
    const glow = glow_of(degc);
    block.material.color.set(STEEL).lerp(BLACK, glow?.dims ?? 0);
    block.material.emissive.copy(glow?.colour ?? BLACK);
  };
  show(parameter(component, "initial") ?? 20);
  return {
    node, follows: ["temperature_degc"],
    show: (value) => {
      const degc = value("temperature_degc");
      if (degc !== null) show(degc);
    },
  };
}

/** A tank with a motor on it, and an accumulator. */
function unit(): Standing {
  const node = new Group().add(
    placed(new BoxGeometry(0.6, 0.4, 0.35), PAINT, at(0, 0, 0.175)), placed(new BoxGeometry(0.64, 0.44, 0.02), DARK_STEEL, at(0, 0, 0.36)),
    bar(at(-0.22, 0, 0.47), at(0.08, 0, 0.47), 0.09, STEEL), bar(at(0.08, 0, 0.47), at(0.2, 0, 0.47), 0.06, DARK_STEEL),
    bar(at(0.22, 0.12, 0.37), at(0.22, 0.12, 0.75), 0.06, "#b3402e"));
  const lamp = placed(upright(0.02, 0.02), "#3d4449", at(-0.25, -0.18, 0.38));
  node.add(lamp);
  return { node, follows: ["pump"], show: (value) => void lamp.material.color.set((value("pump") ?? 0) === 0 ? "#3d4449" : "#2fae4d") };
}

/** A threaded barrel with its face to the front, and a light that is on while it switches. */
function ray_switch(component: Component): Standing {
  const rated = parameter(component, "rated") ?? 0.008;
  const radius = Math.min(0.03, Math.max(0.006, rated));
  const light = placed(upright(radius * 1.02, radius * 0.4), "#5a4a20", at(0, 0, -radius * 5));
  const node = new Group().add(
    bar(at(0, 0, -radius * 6), at(0, 0, -radius * 0.3), radius, STEEL), bar(at(0, 0, -radius * 0.3), at(0, 0, 0), radius * 0.96, component.kind === "inductive_sensor" ? "#2f6f9f" : "#d08020"),
    placed(upright(radius * 1.5, radius * 0.5, 6), DARK_STEEL, at(0, 0, -radius * 2)), light);
  return {
    node, follows: ["detected"],
    show: (value) => {
      light.material.emissive.set((value("detected") ?? 0) === 0 ? "#000000" : "#ffb000");
    },
  };
}
