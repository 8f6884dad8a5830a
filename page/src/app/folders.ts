import { signal, type Signal } from "@preact/signals";
import type { Outcome } from "../engine/connection";
import type { EngineEvent, PageRequest } from "../protocol";
import { isWithin, joined, stemOf } from "./paths";
import type { PageRemedy } from "./remedies";
import { RememberedList } from "./remembered";
import type { Failure } from "./wording";

type Welcome = Extract<EngineEvent, { event: "welcome" }>;

/** Full paths of the folders that were added in this browser. */
const added = new RememberedList("folder");

/** The objects of the editor that folders use. */
export interface FoldersLinks {
  readonly welcome: Signal<Welcome | null>;
  attempt(request: PageRequest): Promise<Outcome | Failure>;
  ask(request: PageRequest): Promise<Outcome | undefined>;
  note(problem: string, remedy: string, offered: PageRemedy): void;
  tellFiles(done: string, outcome: Outcome): void;
}

/** The folders whose files may be used: those that the engine started with, and those that the user adds. */
export class Folders {
  /** The folder that the part library shows; null if it shows the samples. */
  readonly ofParts = signal<string | null>(null);

  constructor(private readonly links: FoldersLinks) {}

  /** Adds a folder, in later sessions of this browser, too. Resolves with its path or with the reason why it failed. */
  async add(path: string): Promise<string | Failure> {
    const answer = await this.attempt(path);
    if (typeof answer === "string") added.add(answer);
    return answer;
  }

  isAdded(path: string): boolean {
    return added.items.value.includes(path);
  }

  /** Takes an added folder off the list. The engine may use it until it ends. */
  forget(path: string): void {
    added.remove(path);
    this.setFolders((folders) => folders.filter((one) => one !== path));
    if (this.ofParts.value !== null && isWithin(path, this.ofParts.value)) this.ofParts.value = null;
  }

  /** Adds the folders of earlier sessions. Those that are not there now, such as on another disk, are left out. */
  onWelcome({ folders, models }: Welcome): void {
    if (this.links.welcome.value === null && models.length > 0) this.ofParts.value = folders[0] ?? null;
    this.addMissing(folders);
  }

  /** Takes over the folders that other tabs add. */
  followOtherTabs(): void {
    added.followOtherTabs(() => this.addMissing(this.links.welcome.value?.folders ?? []));
  }

  private addMissing(known: readonly string[]): void {
    for (const path of added.items.value) if (!known.includes(path)) void this.attempt(path);
  }

  /** Writes an object as it is shown to the part library's folder, under a new name. Without `part` it is the model. */
  async saveAsPart(name: string, part?: string): Promise<void> {
    const folder = this.ofParts.value ?? this.links.welcome.value?.folders[0];
    if (folder === undefined) return this.links.note("There is no folder for parts", "Add one in the part library.", "library");
    const listing = await this.links.ask({ do: "list", folder });
    if (listing === undefined) return;
    const taken = new Set((listing.files ?? []).map((file) => (typeof file === "string" ? file : file.name)));
    const path = joined(folder, newName(name, taken));
    const written = await this.links.ask({ do: "export", path, as: "mesh", ...(part !== undefined && { mesh: part }) });
    if (written === undefined) return;
    this.ofParts.value = folder;
    this.links.tellFiles("Saved as a part", written);
  }

  private async attempt(path: string): Promise<string | Failure> {
    const answer = await this.links.attempt({ do: "add-folder", path });
    if ("code" in answer) return answer;
    this.setFolders(() => answer.folders ?? []);
    return answer.folder ?? path;
  }

  private setFolders(change: (folders: readonly string[]) => string[]): void {
    const { welcome } = this.links;
    if (welcome.value !== null) welcome.value = { ...welcome.value, folders: change(welcome.value.folders) };
  }
}

/** Returns a name for a PLY file that none of the files has. Lists show names without extensions, so these differ, too. */
export function newName(stem: string, taken: ReadonlySet<string>): string {
  const wanted = stem.replace(/[/\\\s]+/g, "_").replace(/^\.+/, "") || "part";
  const stems = new Set([...taken].map(stemOf));
  for (let k = 1; ; ++k) {
    const name = k === 1 ? wanted : `${wanted}_${k}`;
    if (!stems.has(name)) return `${name}.ply`;
  }
}
