// The edges of bodies as thin lines, as in the drawings of `onescan describe --svg`.

import {
  EdgesGeometry, InstancedBufferGeometry, LineBasicMaterial, LineSegments, ShaderMaterial, type BufferGeometry, type InstancedMesh,
} from "three";

/** Two triangles that meet at less than this are one surface, °. */
const SHARP_DEG = 30;
const COLOUR = "#14191c";
const OPACITY = 0.55;

const lines = new Map<BufferGeometry, EdgesGeometry>();
const material = new LineBasicMaterial({ color: COLOUR, transparent: true, opacity: OPACITY });
const crowd_material = new ShaderMaterial({
  transparent: true,
  clipping: true,
  vertexShader: `
    #include <clipping_planes_pars_vertex>
    attribute mat4 instanceMatrix;
    void main() {
      vec4 mvPosition = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
      gl_Position = projectionMatrix * mvPosition;
      #include <clipping_planes_vertex>
    }`,
  fragmentShader: `
    #include <clipping_planes_pars_fragment>
    void main() {
      #include <clipping_planes_fragment>
      gl_FragColor = vec4(0.006, 0.01, 0.012, ${OPACITY});
    }`,
});

function edges_of(geometry: BufferGeometry): EdgesGeometry {
  let known = lines.get(geometry);
  if (known === undefined) lines.set(geometry, (known = new EdgesGeometry(geometry, SHARP_DEG)));
  return known;
}

/** The edges of a body that is drawn by itself. */
export function edges(geometry: BufferGeometry): LineSegments {
  return quiet(new LineSegments(edges_of(geometry), material));
}

/** The edges of many bodies of one shape, where the mesh has them. */
export function crowd_edges(mesh: InstancedMesh): LineSegments {
  const all = new InstancedBufferGeometry();
  all.setAttribute("position", edges_of(mesh.geometry).getAttribute("position"));
  all.setAttribute("instanceMatrix", mesh.instanceMatrix);
  all.instanceCount = mesh.count;
  const drawn = quiet(new LineSegments(all, crowd_material));
  drawn.frustumCulled = false;
  return drawn;
}

/** Draws them, or none: lines are dear where the processor draws them. */
export function show_edges(areShown: boolean): void {
  [material.visible, crowd_material.visible] = [areShown, areShown];
}

/** A click goes through a line to the body. */
function quiet(drawn: LineSegments): LineSegments {
  drawn.raycast = () => {};
  return drawn;
}
