import {
  Color,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  OrthographicCamera,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderTarget,
  type Quaternion,
  type WebGLRenderer,
} from "three";
import type { Surface } from "./surface/surface";

/** A surface of a small picture: its map to the world and its colour, components from 0 to 1. */
export interface Pictured {
  readonly surface: Surface;
  readonly matrix: Matrix4;
  readonly colour: readonly [number, number, number];
}

/** What a small picture shows, and how: around a sphere of the world, `pixels` wide and high. */
export interface SmallPicture {
  readonly shown: readonly Pictured[];
  readonly around: Sphere;
  readonly pixels: number;
}

/** Draws surfaces as a camera of this orientation sees them. Returns a square PNG without background, as a data URL. */
export async function smallPicture(
  renderer: WebGLRenderer,
  { shown, around, pixels }: SmallPicture,
  orientation: Quaternion,
): Promise<string> {
  const scene = new Scene();
  const towards = new Vector3(0, 0, 1).applyQuaternion(orientation);
  const light = new DirectionalLight(0xffffff, 2.6);
  light.position.copy(new Vector3(-0.5, 0.7, 0.9).applyQuaternion(orientation));
  scene.add(light, new HemisphereLight(0xffffff, 0x9a9fb0, 2));
  const materials = shown.map(({ surface, matrix, colour }) => addTo(scene, surface, matrix, colour));
  const camera = cameraAround(around, boundsOf(shown).radius, orientation, towards);
  const target = new WebGLRenderTarget(pixels, pixels);
  const before = { colour: renderer.getClearColor(new Color()), alpha: renderer.getClearAlpha() };
  renderer.setRenderTarget(target);
  renderer.setClearColor(0x000000, 0);
  renderer.clear();
  renderer.render(scene, camera);
  renderer.setRenderTarget(null);
  renderer.setClearColor(before.colour, before.alpha);
  const bytes = new Uint8Array(4 * pixels * pixels);
  await renderer.readRenderTargetPixelsAsync(target, 0, 0, pixels, pixels, bytes);
  target.dispose();
  for (const material of materials) material.dispose();
  return dataUrlOf(bytes, pixels);
}

function addTo(scene: Scene, surface: Surface, matrix: Matrix4, [red, green, blue]: Pictured["colour"]): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ color: new Color(red, green, blue), side: DoubleSide });
  const drawn = new Mesh(surface.geometry, material);
  drawn.matrixAutoUpdate = false;
  drawn.matrix.copy(matrix).multiply(new Matrix4().makeTranslation(surface.object.position));
  drawn.frustumCulled = false;
  scene.add(drawn);
  return material;
}

function boundsOf(shown: readonly Pictured[]): Sphere {
  const bounds = new Sphere(new Vector3(), -1);
  for (const { surface, matrix } of shown) bounds.union(surface.sphere().applyMatrix4(matrix));
  return bounds;
}

function cameraAround({ center, radius }: Sphere, depth: number, orientation: Quaternion, towards: Vector3): OrthographicCamera {
  const camera = new OrthographicCamera(-radius, radius, radius, -radius, 0, 8 * depth);
  camera.quaternion.copy(orientation);
  camera.position.copy(center).addScaledVector(towards, 4 * depth);
  camera.updateMatrixWorld();
  return camera;
}

/** Returns a picture from rows of pixels, the lowest first. */
function dataUrlOf(bytes: Uint8Array, pixels: number): string {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = pixels;
  const pen = canvas.getContext("2d");
  if (pen === null) return "";
  const picture = pen.createImageData(pixels, pixels);
  for (let row = 0; row < pixels; ++row)
    picture.data.set(bytes.subarray(4 * pixels * row, 4 * pixels * (row + 1)), 4 * pixels * (pixels - 1 - row));
  pen.putImageData(picture, 0, 0);
  return canvas.toDataURL();
}
