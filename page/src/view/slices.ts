/** Does long work in slices, so that the page stays alive: what yields now and then is taken up again in a later task. */
export class Slices {
  private readonly running = new Map<string, Generator<void, void>>();

  private isGoing = false;
  private readonly channel = new MessageChannel(); // timers would wait for 4 ms each

  constructor(private readonly budgetMs = 10) {
    this.channel.port1.onmessage = () => {
      if (!this.go(performance.now() + this.budgetMs)) this.later();
    };
  }

  /** Begins `work`; what still ran by that name is given up. */
  start(name: string, work: Generator<void, void>): void {
    const idle = this.running.size === 0;
    this.running.set(name, work);
    if (this.isGoing) return; // begun by such work itself
    if (!this.go(performance.now() + this.budgetMs) && idle) this.later();
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

  private later(): void {
    this.channel.port2.postMessage(null);
  }

  private go(until: number): boolean {
    this.isGoing = true;
    const isDone = this.goOn(until);
    this.isGoing = false;
    return isDone;
  }

  private goOn(until: number): boolean {
    for (const [name, work] of this.running)
      for (;;) {
        if (work.next().done === true) {
          if (this.running.get(name) === work) this.running.delete(name);
          break;
        }
        if (this.running.get(name) !== work) break;
        if (performance.now() > until) return false;
      }
    return this.running.size === 0;
  }
}
