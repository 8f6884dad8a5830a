/**
 * Runs long computations in slices, so that the page stays responsive. A generator that yields is continued in a later
 * task.
 */
export class Slices {
  private readonly running = new Map<string, Generator<void, void>>();

  private isInSlice = false;
  private isAwaited = false; // whether the next slice is scheduled
  private readonly channel = new MessageChannel(); // timers would wait for 4 ms each

  constructor(private readonly budgetMs = 10) {
    this.channel.port1.onmessage = () => {
      this.isAwaited = false;
      this.runSlice();
    };
  }

  /** Starts `work`, and cancels running work of the same name. */
  start(name: string, work: Generator<void, void>): void {
    this.running.set(name, work);
    if (!this.isInSlice) this.runSlice(); // otherwise running work has started it
  }
  isRunning(name: string): boolean {
    return this.running.has(name);
  }
  stop(name: string): void {
    this.running.delete(name);
  }
  stopAll(): void {
    this.running.clear();
  }

  private runSlice(): void {
    this.isInSlice = true;
    try {
      this.runUntil(performance.now() + this.budgetMs);
    } finally {
      this.isInSlice = false;
      if (this.running.size > 0) this.scheduleSlice();
    }
  }

  private scheduleSlice(): void {
    if (!this.isAwaited) this.channel.port2.postMessage(null);
    this.isAwaited = true;
  }

  private runUntil(until: number): void {
    for (const [name, work] of this.running)
      for (;;) {
        if (work.next().done === true) {
          if (this.running.get(name) === work) this.running.delete(name);
          break;
        }
        if (this.running.get(name) !== work) break;
        if (performance.now() > until) return;
      }
  }
}
