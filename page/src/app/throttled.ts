/** Sends one value at a time. While one is on its way, only the newest value waits; older ones are dropped. */
export class Throttled<Value> {
  private waiting: { value: Value } | undefined;
  private busy = false;

  constructor(private readonly deliver: (value: Value) => Promise<void>) {}

  send(value: Value): void {
    this.waiting = { value };
    if (!this.busy) void this.run();
  }

  /** Drops the waiting value. */
  forget(): void {
    this.waiting = undefined;
  }

  private async run(): Promise<void> {
    this.busy = true;
    while (this.waiting !== undefined) {
      const { value } = this.waiting;
      this.waiting = undefined;
      await this.deliver(value);
    }
    this.busy = false;
  }
}
