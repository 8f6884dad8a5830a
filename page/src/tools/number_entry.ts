/** A number that is typed while a gesture goes on. */
export class NumberEntry {
  private typed = "";
  private negative = false;

  /** What was typed, as it stands; empty: nothing. */
  get text(): string {
    return this.typed === "" && !this.negative ? "" : (this.negative ? "-" : "") + this.typed;
  }

  /** Undefined: nothing that is a number yet. */
  get value(): number | undefined {
    const number = Number.parseFloat(this.typed);
    if (Number.isNaN(number)) return undefined;
    return this.negative ? -number : number;
  }

  /** Takes a key of a number, as `KeyboardEvent.key` has it; returns whether it was one. */
  press(key: string): boolean {
    if (/^\d$/.test(key)) this.typed += key;
    else if (key === "." || key === ",") this.typed += this.typed.includes(".") ? "" : this.typed === "" ? "0." : ".";
    else if (key === "-") this.negative = !this.negative;
    else if (key === "Backspace") this.erase();
    else return false;
    return true;
  }

  clear(): void {
    this.typed = "";
    this.negative = false;
  }

  private erase(): void {
    if (this.typed !== "") this.typed = this.typed.slice(0, -1);
    else this.negative = false;
  }
}
