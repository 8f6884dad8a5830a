import { expect, test } from "vitest";
import { Throttled } from "../../src/app/throttled";

test("drops all but the newest while one is on its way", async () => {
  const sent: number[] = [];
  let arrive = (): void => undefined;
  const throttled = new Throttled<number>((value) => {
    sent.push(value);
    return new Promise((resolve) => (arrive = resolve));
  });
  for (const value of [1, 2, 3, 4]) throttled.send(value);
  expect(sent).toEqual([1]);
  arrive();
  await Promise.resolve();
  expect(sent).toEqual([1, 4]);
  throttled.send(5);
  throttled.forget();
  arrive();
  await Promise.resolve();
  expect(sent).toEqual([1, 4]);
});
