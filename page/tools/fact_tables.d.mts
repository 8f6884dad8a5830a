export type Kind = "integer" | "number" | "text" | "integers" | "numbers" | "texts";

/** A row of a table of facts. An error has a problem and a code, a note has a note. */
export interface Row {
  id: string;
  code?: string;
  problem?: string;
  note?: string;
  remedy?: string;
  fields?: Record<string, Kind>;
}

export function tables(): Promise<string[]>;
export function rowsOf(table: string): Promise<Row[]>;
