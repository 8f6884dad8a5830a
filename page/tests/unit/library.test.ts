import { expect, test } from "vitest";
import { Library } from "../../src/app/library";
import type { Outcome } from "../../src/engine/connection";
import type { PageRequest } from "../../src/protocol";

/** A mock engine that records requests, and answers when the test says so. */
class Engine {
  readonly asked: string[] = [];
  private last = 0;
  private running: { id: number; made: () => void; cancelled: () => void } | undefined;

  readonly library = new Library((request: PageRequest) => {
    const id = ++this.last;
    if (request.do === "cancel") {
      this.asked.push("cancel");
      if (request.of === this.running?.id) this.running?.cancelled();
      return { id, answer: Promise.resolve({} as Outcome) };
    }
    if (request.do !== "thumbnail") throw new Error(`${request.do} is not asked for`);
    this.asked.push("path" in request ? (request.path ?? "") : "");
    const answer = new Promise<Outcome>((resolve, reject) => {
      this.running = { id, made: () => resolve({} as Outcome), cancelled: () => reject(new Error("cancelled")) };
    });
    return { id, answer };
  });

  async make(): Promise<void> {
    this.running?.made();
    await settled();
  }
}

const settled = () => new Promise((resolve) => setTimeout(resolve));

test("pictures that are no longer shown are not made, and are made once they are shown again", async () => {
  const engine = new Engine();
  const { library } = engine;
  const files = ["octopus", "head", "bust"];
  for (const path of files) library.picture({ path });
  const [, hideHead, hideBust] = files.map((path) => library.show({ path }));
  const hideBustElsewhere = library.show({ path: "bust" });
  hideHead?.();
  hideBust?.();
  await settled();
  await engine.make();
  await engine.make();
  expect(engine.asked).toEqual(["octopus", "bust"]);
  hideBustElsewhere();
  library.picture({ path: "head" });
  library.picture({ path: "octopus" });
  await settled();
  expect(engine.asked).toEqual(["octopus", "bust", "head"]);
});

test("pictures give way to other work, and are made after it", async () => {
  const engine = new Engine();
  const first = engine.library.picture({ path: "octopus" });
  engine.library.picture({ path: "head" });
  await settled();
  expect(engine.asked).toEqual(["octopus"]);

  let finish = (): void => undefined;
  engine.library.pauseFor(new Promise<void>((resolve) => (finish = resolve)));
  await settled();
  expect(engine.asked).toEqual(["octopus", "cancel"]);
  expect(first.value).toBe(null); // still to come

  finish();
  await settled();
  await engine.make();
  await engine.make();
  expect(engine.asked).toEqual(["octopus", "cancel", "octopus", "head"]);
});

test("samples have pictures without the engine", () => {
  const engine = new Engine();
  expect(engine.library.picture({ sample: "octopus" }).value).toBe("samples/octopus.png");
  expect(engine.asked).toEqual([]);
});
