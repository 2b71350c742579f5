// What can be placed, in groups, each thing with a small picture.

import { draw } from "../dom";
import type { Text } from "../say";

/** A group of the library, and what is in it: each thing with its picture, drawn on a square of 24. */
interface Group {
  readonly title: Text;
  readonly pictures: Readonly<Record<string, string>>;
}

const BEAM = "M3 8h4v8H3zM17 8h4v8h-4zM7 12h2M11 12h2M15 12h2";
const PROBE = "M5 4h6v11H5zM5 8h6M8 15v3M13 18q2-2 0-4M16 20q4-4 0-8";
const THERMOMETER = "M10 4a2 2 0 0 1 4 0v10a4 4 0 1 1-4 0zM12 9v8";
const ENCODER = "M12 3a9 9 0 1 1-.01 0zM12 10a2 2 0 1 1-.01 0zM12 3v4M21 12h-4M12 21v-4M3 12h4";
const AXIS = "M2 17h20M5 17v2M19 17v2M8 9h8v8H8zM12 9V5";
const DRUM = "M3 8h18v8H3zM3 8q2 4 0 8M21 8q2 4 0 8M8 16v4M16 16v4";
const MOTOR = "M3 7h13v10H3zM16 10h5v4h-5zM6 17v3M13 17v3";

export const GROUPS: readonly Group[] = [
  {
    title: "Bodies and joints",
    pictures: {
      belt: "M3 10h18v4H3zM6 14v5M18 14v5", box: "M4 8l8-4 8 4v8l-8 4-8-4zM4 8l8 4 8-4M12 12v8", table: "M3 8h18v3H3zM5 11v9M19 11v9",
      zone: "M4 4h3M10 4h4M17 4h3v3M20 10v4M20 17v3h-3M14 20h-4M7 20H4v-3M4 14v-4M4 7V4", roller: "M5 6a3 6 0 1 0 .01 0M5 6h13M5 18h13M18 6a3 6 0 0 1 0 12",
      slide: "M3 16h18M8 8h8v8H8zM4 12h3M4 12l2-2M4 12l2 2M20 12h-3M20 12l-2-2M20 12l-2 2", hinge: "M12 12a3 3 0 1 1-.01 0zM12 15L5 21M14 11l7-5M18 15a8 8 0 0 1-6 5",
    },
  },
  {
    title: "Drives",
    pictures: {
      pneumatic_cylinder: "M3 8h12v8H3zM9 8v8M9 12h12M21 9v6M5 16v3M13 16v3", hydraulic_cylinder: "M3 7h12v10H3zM3 7v10M8 7v10M10 7v10M10 11h11M10 13h11M21 9v6",
      servo_axis: AXIS, command_axis: `${AXIS}M4 4h5M4 6h3`, force_drive: "M3 10h9v6H3zM12 13h8M20 13l-3-3M20 13l-3 3", torque_drive: "M12 5a7 7 0 1 1-6 4M6 9V5M6 9h4M12 10a2 2 0 1 1-.01 0z",
      asynchronous_motor: MOTOR, conveyor: "M6 9h12a3.5 3.5 0 0 1 0 7H6a3.5 3.5 0 0 1 0-7zM6 11.5v2M12 11.5v2M18 11.5v2M8 4h6v4H8z", arm: "M5 20h6M8 20v-8l7-5M15 7l5 2M20 9l-1 3M20 9l2 2",
      gripper: "M8 3h8v5H8zM7 8v4l3 2v6M17 8v4l-3 2v6M12 8v3", vacuum_cup: "M12 3v7M8 10h8l3 6H5zM4 19h16", turntable: "M12 6a9 4 0 1 1-.01 0zM12 14v6M8 20h8M16 9l2 2-3 1",
      spindle: "M8 3h8v6H8zM10 9h4v5h-4zM11 14h2v7h-2zM11 17l2 1M11 19l2 1", stopper: "M3 14h6M15 14h6M10 6h4v14h-4zM6 7v4M6 7L4 9M6 7l2 2", lift_table: "M4 5h16v2H4zM4 19h16v2H4zM6 19L18 7M18 19L6 7",
      rack_feeder: "M7 3v17M9 3v17M4 20h10M9 10h5v4H9zM14 12h6M18 4v6M18 14v6",
    },
  },
  {
    title: "Sensors",
    pictures: {
      light_barrier: BEAM, inductive_sensor: PROBE, capacitive_sensor: `${PROBE}M5 12h6`, limit_switch: "M4 12h9v8H4zM8 12l7-6M15 6a2 2 0 1 1 .01 0", incremental_encoder: ENCODER, absolute_encoder: `${ENCODER}M6 6l2 2M18 6l-2 2M6 18l2-2M18 18l-2-2`,
      pressure_sensor: "M12 4a7 7 0 1 1-.01 0zM12 11l4-3M10 18v3M14 18v3", temperature_sensor: THERMOMETER, pyrometer: "M3 9h9v6H3zM12 12h4M18 6q3 6 0 12M21 4q4 8 0 16", infrared_scanner: "M8 3h8v5H8zM12 8L4 20M12 8l8 12M6 20h12",
      contact_sensor: "M4 14h8v6H4zM8 14v-4M6 10h4M14 4h6v6h-6zM12 8l-2 2", collision_monitor: "M3 5h8v8H3zM13 11h8v8h-8zM12 4l1 3M15 6l2-2M16 9h3", line_scanner: "M7 3h10v6H7zM12 9L6 20h12z", camera: "M3 7h12v10H3zM15 10l6-3v10l-6-3zM9 9.5a2.5 2.5 0 1 1-.01 0z",
      laser_distance: "M3 9h6v6H3zM9 12h11M20 7v10M12 10l-3 2 3 2", axis_encoder: ENCODER, pose_sensor: "M8 16V5M8 5L6 7M8 5l2 2M8 16h11M19 16l-2-2M19 16l-2 2M8 16l-5 5", inclinometer: "M4 19h16M4 19L18 8M10 19a7 7 0 0 0-1.500-4", accelerometer: "M7 7h10v10H7zM12 12h8M20 12l-2-2M20 12l-2 2",
      light_curtain: "M3 3h4v18H3zM17 3h4v18h-4zM7 6h10M7 10h10M7 14h10M7 18h10", barcode_reader: "M4 5h2v14H4zM8 5v14M11 5h2v14h-2zM16 5v14M19 5h1v14h-1z", rfid_head: "M5 4h6v16H5zM14 8q3 4 0 8M17 6q5 6 0 12",
      weighing_cell: "M5 6h14v3H5zM12 9v4M6 13h12l2 7H4zM9 17h6",
    },
  },
  {
    title: "Process",
    pictures: {
      tank: "M5 5v13q7 4 14 0V5M5 5q7-3 14 0M5 5q7 3 14 0M5 12q7 3 14 0", hydraulic_unit: "M3 13h18v7H3zM8 7a4 4 0 1 1 .01 0zM16 4v9M14 6l2-2 2 2", heater: "M3 18h18M6 18q-2-3 0-5t0-5M12 18q-2-3 0-5t0-5M18 18q-2-3 0-5t0-5",
      workpiece_source: "M4 4h7v7H4zM11 14h9M20 14l-3-3M20 14l-3 3M4 15v5h16", workpiece_sink: "M13 4h7v7h-7zM4 14h9M13 14l-3-3M13 14l-3 3M4 20h16v-5",
      veneer_lathe: "M9 12a5 5 0 1 1-.01 0zM9 7q7 0 12-3M4 20h10", kiln_shell: DRUM, kiln_heat: `${DRUM}M9 12q1-2 2 0t2 0 2 0`, arc_circuit: "M6 3v7M12 3v7M18 3v7M6 10l-1 4h2l-1 4M12 10l-1 4h2l-1 4M18 10l-1 4h2l-1 4M3 20h18",
      electrode_mast: "M5 3v18M5 6h11M16 4v15M14 19h4", arc_bath: "M3 8v6q9 10 18 0V8M3 13q4-2 9 0t9 0", cooled_panel: "M4 4h16v16H4zM8 4v16M12 4v16M16 4v16",
    },
  },
  {
    title: "Panel and logic",
    pictures: {
      push_button: "M5 14h14v6H5zM8 14V9h8v5M12 3v4M10 5l2 2 2-2", emergency_stop: "M6 15h12v5H6zM4 12a8 7 0 0 1 16 0zM10 12v3M14 12v3", stack_light: "M9 3h6v4H9zM9 7h6v4H9zM9 11h6v4H9zM12 15v5M8 20h8", key_switch: "M12 3a9 9 0 1 1-.01 0zM12 8v8M10 10h4M12 3v2M4 8l2 1",
      two_hand_station: "M3 11h18v8H3zM7 11V8M17 11V8M5 8q2-4 4 0zM15 8q2-4 4 0z", lamp: "M8 11a4 4 0 1 1 8 0v5H8zM7 16h10v4H7zM12 2v2M4 6l2 1M20 6l-2 1", input_controller: "M5 4v16M12 4v16M19 4v16M3 9h4M10 15h4M17 7h4",
      gate: "M6 5h6a7 7 0 0 1 0 14H6zM2 9h4M2 15h4M19 12h3", loopback: "M4 8h10a4 4 0 0 1 0 8H6M6 16l3-3M6 16l3 3",
    },
  },
];

/** What a kind that we do not know looks like: a part of one's own. */
const OWN = "M4 7h7V4h4v3h5v13H4zM9 13h6M12 10v6";

/** The group of a kind of the library; nothing of one's own kinds. */
export function group_of(kind: string): Text | null {
  return GROUPS.slice(1).find((group) => kind in group.pictures)?.title ?? null;
}

/** The picture of a thing that can be placed. */
export function picture_of(name: string): SVGElement {
  const path = GROUPS.map((group) => group.pictures[name]).find((one) => one !== undefined) ?? OWN;
  return draw("svg", { viewBox: "0 0 24 24", class: "ware-picture", "aria-hidden": "true" }, draw("path", { d: path }));
}
