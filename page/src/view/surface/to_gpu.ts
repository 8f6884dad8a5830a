import { BufferGeometry, Points, Scene, type Camera, type Material, type WebGLRenderer } from "three";
import { waitForGpu } from "../frame_scheduler";
import type { Surface } from "./surface";

/**
 * Brings a surface's arrays to the GPU one after another, while it `isWanted`. `compiled`: a material already in use.
 */
export async function uploadToGpu(
  surface: Surface,
  renderer: WebGLRenderer,
  compiled: Material,
  camera: Camera,
  isWanted: () => boolean,
): Promise<void> {
  const scene = new Scene();
  const points = new Points(new BufferGeometry(), compiled);
  points.frustumCulled = false;
  scene.add(points);
  for (const geometry of surface.uploadGeometries()) {
    await waitForGpu(renderer);
    if (!isWanted()) return;
    points.geometry = geometry;
    renderer.render(scene, camera);
  }
  await waitForGpu(renderer);
}
