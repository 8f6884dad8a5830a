import { BufferGeometry, Points, Scene, type Camera, type Material, type WebGLRenderer } from "three";
import { cardIsIdle } from "../frame_scheduler";
import type { Surface } from "./surface";

/**
 * Brings a surface's arrays to the GPU one after another, while it `isWanted`. `compiled`: a material already in use.
 */
export async function bringToGpu(
  surface: Surface,
  renderer: WebGLRenderer,
  compiled: Material,
  camera: Camera,
  isWanted: () => boolean,
): Promise<void> {
  const stage = new Scene();
  const carrier = new Points(new BufferGeometry(), compiled);
  carrier.frustumCulled = false;
  stage.add(carrier);
  for (const geometry of surface.attributesAlone()) {
    await cardIsIdle(renderer);
    if (!isWanted()) return;
    carrier.geometry = geometry;
    renderer.render(stage, camera);
  }
  await cardIsIdle(renderer);
}
