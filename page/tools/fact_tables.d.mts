export type Kind = "integer" | "number" | "text" | "integers" | "numbers" | "texts";

/** The words that a field may have, with the library's English for each. */
export type Words = Record<string, string>;

/** A row of a table of facts. An error has a problem and a code, a note has a note. */
export interface Row {
  id: string;
  code?: string;
  problem?: string;
  note?: string;
  remedy?: string;
  fields: Record<string, Kind | Words>;
}

export function tables(): Promise<string[]>;
export function rowsOf(table: string): Promise<Row[]>;
