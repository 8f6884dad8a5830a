import type { DocumentState } from "../protocol";

type Group = DocumentState["groups"][number];

/**
 * Returns the named selections that the user made, without those that handles of any step keep under their own names.
 */
export function groupsOf(state: DocumentState | null): Group[] {
  if (state === null) return [];
  const taken = new Set(state.handles.map(({ name }) => name));
  for (const { fields } of state.steps)
    for (const name of namesIn("handles" in fields ? fields.handles : undefined)) taken.add(name);
  return state.groups.filter(({ name }) => !taken.has(name));
}

function namesIn(list: unknown): string[] {
  return Array.isArray(list) ? list.map((handle: { name?: unknown }) => String(handle.name)) : [];
}
