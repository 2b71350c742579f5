// Light on the machine: a sun that casts shadows, on the machine and on the floor; the sky; none of the shadows where the
// graphics are slow.

import {
  AmbientLight, Color, DirectionalLight, HemisphereLight, Mesh, PCFShadowMap, PlaneGeometry, ShadowMaterial, Vector3, type Scene, type WebGLRenderer,
} from "three";
import type { Room } from "./framing";

/** From where the sun shines: above the shoulder of who sees the whole machine. */
const SUN = new Vector3(0.35, -0.55, 1).normalize();
const SHADOW_PIXELS = 1024;
/** Shadows fall beside the machine, too: so far as its size and this share of it. */
const BESIDE = 0.35;

export class Light {
  private readonly sun = new DirectionalLight("#ffffff", 1.9);
  private readonly sky = new HemisphereLight("#ffffff", "#6d7378", 1.1);
  private readonly all = new AmbientLight("#ffffff", 0.25);
  private readonly ground = new Mesh(new PlaneGeometry(1, 1), new ShadowMaterial({ opacity: 0.28, depthWrite: false }));

  constructor(
    private readonly renderer: WebGLRenderer,
    scene: Scene,
  ) {
    const fill = new DirectionalLight("#dfe8ff", 0.6);
    fill.position.set(-5, 3, 3);
    this.sky.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
    this.ground.receiveShadow = true;
    // It is no part that one clicks.
    this.ground.raycast = () => {};
    renderer.shadowMap.type = PCFShadowMap;
    scene.add(this.sun, this.sun.target, fill, this.sky, this.all, this.ground);
  }

  /** Aims at the machine, which stands on a floor at `floor_m`. */
  aim({ low, high }: Room, floor_m: number): void {
    const middle = new Vector3(...low).add(new Vector3(...high)).multiplyScalar(0.5);
    const reach_m = Math.max(0.2, new Vector3(...high).distanceTo(new Vector3(...low)) / 2) * (1 + BESIDE);
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).addScaledVector(SUN, 2 * reach_m);
    const { camera } = this.sun.shadow;
    [camera.left, camera.right, camera.bottom, camera.top] = [-reach_m, reach_m, -reach_m, reach_m];
    // What is below the machine gets its shadow, too.
    [camera.near, camera.far] = [0.01 * reach_m, 4 * reach_m + 2 * Math.max(0, low[2] - floor_m)];
    camera.updateProjectionMatrix();
    this.sun.shadow.normalBias = 0.004 * reach_m;
    this.sun.shadow.bias = -0.0005;
    this.ground.position.set(middle.x, middle.y, floor_m - 0.001 * reach_m);
    this.ground.scale.setScalar(6 * reach_m);
  }

  /** Shadows, or none. */
  cast(isCast: boolean): void {
    this.renderer.shadowMap.enabled = isCast;
    this.sun.castShadow = isCast;
    this.ground.visible = isCast;
  }

  /** A dark room has more light from all sides and less from above: what turns away is not lost in it, and a white floor does not glare. */
  theme(background: Color): void {
    const isDark = background.getHSL({ h: 0, s: 0, l: 0 }).l < 0.4;
    this.sun.intensity = isDark ? 1.2 : 1.9;
    this.sky.intensity = isDark ? 1.2 : 1.1;
    this.all.intensity = isDark ? 0.6 : 0.25;
    this.ground.material.opacity = isDark ? 0.5 : 0.28;
  }
}
