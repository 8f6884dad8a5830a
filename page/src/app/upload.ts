import { signal, type Signal } from "@preact/signals";
import { engineUrl } from "./engine_url";
import { formatBytes } from "./units";
import type { Told } from "./wording";

/** The largest upload that the server accepts, in bytes (`ServerOptions::upload_limit`). */
export const uploadLimit = 2 ** 30;

const droppedFile = "dropped file ";

/** Records the file behind an upload, so that it is known after a reload. */
function rememberUpload(upload: string, { name, size }: File): void {
  try {
    localStorage.setItem(`meshgraft upload ${upload}`, `${name}, ${size} bytes`);
  } catch {
    // The file is then known by the engine's name.
  }
}
/** Returns a key of the file behind an upload: the same for files with one name and size. */
export function keyOfUpload(upload: string): string {
  let file: string | null = null;
  try {
    file = localStorage.getItem(`meshgraft upload ${upload}`);
  } catch {
    // not stored
  }
  return droppedFile + (file ?? upload);
}
export const isKeyOfUpload = (key: string): boolean => key.startsWith(droppedFile);

const formats = [".ply", ".obj", ".off", ".stl", ".glb", ".gltf", ".3mf"];

/** Returns why a file cannot be uploaded, checked before any byte is sent; undefined if it can. */
export function refusalOf(file: { name: string; size: number }): Told | undefined {
  if (file.size > uploadLimit)
    return {
      problem: `The file has ${formatBytes(file.size)}; the browser can send up to ${formatBytes(uploadLimit)}`,
      location: file.name,
      remedy: "Add its folder under Folders, and open it there.",
    };
  if (file.size === 0) return { problem: "The file is empty", location: file.name, remedy: "" };
  if (file.name.toLowerCase().endsWith(".json"))
    return {
      problem: "An edit file needs the models beside it, which the browser cannot read",
      location: file.name,
      remedy: "Add its folder under Folders, and open it there.",
    };
  if (!formats.some((format) => file.name.toLowerCase().endsWith(format)))
    return {
      problem: "This kind of file cannot be opened",
      location: file.name,
      remedy: `Supported formats: ${formats.join(", ")}.`,
    };
  return undefined;
}

/** The upload of one file to the engine. */
export class Upload {
  readonly fraction: Signal<number> = signal(0);
  private readonly request = new XMLHttpRequest();

  constructor(
    readonly file: File,
    private readonly token: string,
  ) {}

  /**
   * Sends the file. Resolves with the engine's name for it, or undefined if it was cancelled. Throws a `Told`.
   */
  send(): Promise<string | undefined> {
    const { request, file } = this;
    return new Promise((resolve, reject: (why: Told) => void) => {
      request.upload.onprogress = ({ loaded, total }) => (this.fraction.value = total > 0 ? loaded / total : 0);
      request.onload = () => {
        if (request.status !== 200) return reject(this.refused());
        const name = request.responseText.trim();
        rememberUpload(name, file);
        resolve(name);
      };
      request.onerror = () =>
        reject({
          problem: "The file could not be sent",
          location: file.name,
          remedy: "Is the program still running where it was started? Then try again.",
        });
      request.onabort = () => resolve(undefined);
      request.open("POST", engineUrl("upload", { token: this.token, name: file.name }));
      request.send(file);
    });
  }

  cancel(): void {
    this.request.abort();
  }

  private refused(): Told {
    const text = this.request.responseText.trim();
    return {
      problem: text === "" ? `The file was refused (${this.request.status})` : text,
      location: this.file.name,
      remedy: "",
    };
  }
}
