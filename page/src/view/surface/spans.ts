// Ascending lists of vertices, and the spans of arrays that they touch.

/** Returns at most about 32 spans that cover an ascending list. Spans are joined across small gaps. */
export function runsOf(vertices: Uint32Array): [number, number][] {
  if (vertices.length === 0) return [];
  const first = vertices[0] as number;
  const last = vertices[vertices.length - 1] as number;
  const least = Math.max(64, (last - first) / 32);
  const runs: [number, number][] = [[first, first]];
  for (const v of vertices) {
    const run = runs[runs.length - 1] as [number, number];
    if (v - run[1] <= least) run[1] = v;
    else runs.push([v, v]);
  }
  return runs;
}

/** Returns the span of elements in only one of two ascending lists; undefined if the lists are equal. */
export function spanOfChange(before: Uint32Array, after: Uint32Array): [number, number] | undefined {
  let i = 0;
  while (i < before.length && i < after.length && before[i] === after[i]) ++i;
  if (i === before.length && i === after.length) return undefined;
  let a = before.length - 1;
  let b = after.length - 1;
  while (a >= i && b >= i && before[a] === after[b]) {
    --a;
    --b;
  }
  const least = Math.min(before[i] ?? Infinity, after[i] ?? Infinity);
  const most = Math.max(a >= i ? (before[a] as number) : -1, b >= i ? (after[b] as number) : -1);
  return [least, most];
}

/** Returns whether two lists are equal, or both absent. */
export function sameList(a: Uint32Array | undefined, b: Uint32Array | undefined): boolean {
  if (a === undefined || b === undefined || a.length !== b.length) return a === b;
  for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}

/** Returns the union of two lists, ascending. */
export function mergedIndices(a: Uint32Array, b: Uint32Array): Uint32Array {
  const all = new Uint32Array(a.length + b.length);
  all.set(a);
  all.set(b, a.length);
  all.sort();
  return all.filter((v, i) => i === 0 || v !== all[i - 1]);
}
