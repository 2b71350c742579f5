// Shapes of bodies as triangles: lengths in metres, what is round along z.

import { BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, Float32BufferAttribute, SphereGeometry } from "three";
import type { Shape } from "./session";

/** The triangles of a shape; nothing for a body without one. */
export function geometry_of(shape: Shape): BufferGeometry | null {
  switch (shape.kind) {
    case "box":
      return new BoxGeometry(...shape.size_m);
    case "cylinder":
      return new CylinderGeometry(shape.radius_m, shape.radius_m, shape.length_m, 40).rotateX(Math.PI / 2);
    case "round":
      return new CylinderGeometry(shape.top_radius_m, shape.radius_m, shape.length_m, 48, 1, shape.open).rotateX(Math.PI / 2);
    case "capsule":
      return new CapsuleGeometry(shape.radius_m, shape.length_m, 8, 24).rotateX(Math.PI / 2);
    case "sphere":
      return new SphereGeometry(shape.radius_m, 28, 18);
    case "mesh": {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new Float32BufferAttribute(shape.positions_m, 3));
      geometry.setIndex([...shape.indices]);
      geometry.computeVertexNormals();
      return geometry;
    }
    case "none":
      return null;
  }
}

/** What bodies with the same triangles have in common. */
export function key_of(name: string, shape: Shape): string {
  return shape.kind === "mesh" ? `mesh ${name}` : JSON.stringify(shape);
}

/** True for a shape that is seen from within, too. */
export function is_open(shape: Shape): boolean {
  return shape.kind === "round" && shape.open;
}
