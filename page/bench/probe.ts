// Records times in the page while it is measured. All are milliseconds of performance.now().

/** A stretch of the page's own work: a listener, a message, an animation frame, a timer. */
export interface Stretch {
  kind: string;
  begin: number;
  end: number;
}

/** A pose that was sent: when the pointer moved, and when the request was sent. */
export interface Asked {
  at: number;
  sent: number;
  pose?: number;
}

/** A frame of positions that was received. */
export interface Arrival {
  pose: number;
  accuracy: string;
  engineMs: number;
  received: number;
}

/** A picture. `at`: time of the pointer event that it shows, if known; `pose`: number of the streamed pose, if any. */
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
  /** The page's long tasks. The browser reports only those of at least 50 ms. */
  longTasks: Stretch[];
}

declare global {
  interface Window {
    records: Records;
  }
}

/** Runs in the page before its own code, and times the browser's calls. Uses no other function. */
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

/** Runs in the loaded page, and follows poses from pointer to picture. Uses no other function. */
export function recordPictures(): void {
  const { viewport } = window.meshgraft;
  const { records } = window;
  let pointer = 0;
  let latest: Asked | undefined;
  let streamed: Arrival | undefined;
  window.addEventListener("pointermove", (event) => (pointer = event.timeStamp), { capture: true });

  const beginPoseRequest = viewport.beginPoseRequest.bind(viewport);
  viewport.beginPoseRequest = () => {
    const asked: Asked = { at: pointer, sent: performance.now() };
    records.asked.push((latest = asked));
    const answered = beginPoseRequest();
    return (pose) => {
      asked.pose = pose;
      answered(pose);
    };
  };
  const show = viewport.show.bind(viewport);
  viewport.show = (frame) => {
    const received = performance.now();
    show(frame);
    const { pose, accuracy, seconds } = frame.header;
    if (frame.kind !== 2 || pose === undefined) return;
    streamed = { pose, accuracy: accuracy ?? "", engineMs: 1000 * (seconds ?? 0), received };
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
