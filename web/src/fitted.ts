// What the shapes of components are made of: solids, bars, colours.

import { BufferGeometry, CylinderGeometry, Mesh, MeshLambertMaterial, Vector3 } from "three";
import type { Component } from "./session";

export const STEEL = "#b9c0c5";
export const DARK_STEEL = "#5f686e";
export const PAINT = "#2f6f9f";
export const HOUSING = "#e0a21a";
export const UP = new Vector3(0, 0, 1);

/** A number among the parameters of a component, in its base unit. */
export function parameter(component: Component, name: string): number | null {
  const found = component.parameters.find((one) => one.name === name);
  const value = found === undefined ? Number.NaN : Number.parseFloat(found.value);
  return Number.isFinite(value) ? value : null;
}

/** A solid that casts and takes shadows. */
export function solid(geometry: BufferGeometry, colour: string): Mesh {
  const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: colour }));
  mesh.castShadow = true;
  mesh.receiveShadow = true;
  return mesh;
}

/** A cylinder from one point to another. */
export function bar(from: Vector3, to: Vector3, radius: number, colour: string): Mesh {
  const way = to.clone().sub(from);
  const mesh = solid(new CylinderGeometry(radius, radius, Math.max(1e-4, way.length()), 20).rotateX(Math.PI / 2), colour);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(UP, way.normalize());
  return mesh;
}
