// What is recorded in the page while it is measured. All times are milliseconds of performance.now().

/** A stretch of the page's own work: a listener, a message, an animation frame, a timer. */
export interface Stretch {
  kind: string;
  begin: number;
  end: number;
}

/** A pose on its way: when the pointer moved, and when the engine was asked. */
export interface Asked {
  at: number;
  sent: number;
  pose?: number;
}

/** A frame of positions that came. */
export interface Arrival {
  pose: number;
  quality: string;
  engineMs: number;
  received: number;
}

/** A picture: what it shows is of the pointer at `at`, undefined where that is not known; `pose` where it was streamed. */
export interface Picture {
  at: number | undefined;
  pose: number | undefined;
  drawn: number;
  end: number;
}

export interface Records {
  stretches: Stretch[];
  asked: Asked[];
  arrivals: Arrival[];
  pictures: Picture[];
  /** Of the page, from 50 ms on: the browser counts no shorter ones. */
  longTasks: Stretch[];
}

declare global {
  interface Window {
    records: Records;
  }
}

/** Runs in the page before all else: times what the browser calls. Stands alone. */
export function recordStretches(): void {
  type Callback = (this: unknown, ...words: never[]) => unknown;
  const records: Records = { stretches: [], asked: [], arrivals: [], pictures: [], longTasks: [] };
  window.records = records;
  let depth = 0;
  const timed = <Call extends Callback>(kind: string, call: Call): Call =>
    function (this: unknown, ...words: never[]) {
      const begin = performance.now();
      ++depth;
      try {
        return call.apply(this, words);
      } finally {
        if (--depth === 0) records.stretches.push({ kind, begin, end: performance.now() });
      }
    } as Call;

  const nextFrame = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (call) => nextFrame(timed("frame", call));
  const later = window.setTimeout.bind(window);
  window.setTimeout = ((call: Callback, ms?: number) => later(timed("timer", call), ms)) as typeof window.setTimeout;
  const listen = EventTarget.prototype.addEventListener;
  EventTarget.prototype.addEventListener = function (type, listener, options) {
    const isPointer = type.startsWith("pointer") && typeof listener === "function";
    listen.call(this, type, isPointer ? timed("pointer", listener as EventListener) : listener, options);
  };
  for (const of of [WebSocket, Worker, MessagePort]) {
    const own = Object.getOwnPropertyDescriptor(of.prototype, "onmessage");
    Object.defineProperty(of.prototype, "onmessage", {
      ...own,
      set(call: Callback) {
        own?.set?.call(this, timed("message", call));
      },
    });
  }
  new PerformanceObserver((list) => {
    for (const { startTime, duration } of list.getEntries())
      records.longTasks.push({ kind: "task", begin: startTime, end: startTime + duration });
  }).observe({ type: "longtask", buffered: true });
}

/** Runs in the page once it is there: follows poses from the pointer to the picture. Stands alone. */
export function recordPictures(): void {
  const { viewport } = window.meshgraft;
  const { records } = window;
  let pointer = 0;
  let latest: Asked | undefined;
  let streamed: Arrival | undefined;
  window.addEventListener("pointermove", (event) => (pointer = event.timeStamp), { capture: true });

  const posesAsked = viewport.posesAsked.bind(viewport);
  viewport.posesAsked = () => {
    const asked: Asked = { at: pointer, sent: performance.now() };
    records.asked.push((latest = asked));
    const answered = posesAsked();
    return (pose) => {
      asked.pose = pose;
      answered(pose);
    };
  };
  const show = viewport.show.bind(viewport);
  viewport.show = (frame) => {
    const received = performance.now();
    show(frame);
    const { pose, quality, seconds } = frame.header;
    if (frame.kind !== 2 || pose === undefined) return;
    streamed = { pose, quality: quality ?? "", engineMs: 1000 * (seconds ?? 0), received };
    records.arrivals.push(streamed);
  };
  let begun: Picture | undefined;
  viewport.onFrame.add(() => {
    const isLinear = viewport.main?.deform.linear.value === true;
    begun = { at: isLinear ? latest?.at : undefined, pose: isLinear ? undefined : streamed?.pose, drawn: 0, end: 0 };
  });
  viewport.onDrawn.add(({ drawn, end }) => {
    if (begun !== undefined) records.pictures.push({ ...begun, drawn, end });
  });
}
