/** A number that is typed while a gesture goes on. */
export class NumberEntry {
  private typed = "";
  private negative = false;

  /** The typed text; empty if nothing was typed. */
  get text(): string {
    return this.typed === "" && !this.negative ? "" : (this.negative ? "-" : "") + this.typed;
  }

  /** The typed number; undefined while the text is not a number yet. */
  get value(): number | undefined {
    const number = Number.parseFloat(this.typed);
    if (Number.isNaN(number)) return undefined;
    return this.negative ? -number : number;
  }

  /** Handles a key, as `KeyboardEvent.key` names it. Returns whether it belongs to a number. */
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
