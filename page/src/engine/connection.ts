import type { EngineError, EngineEvent, Id, PageRequest, Reply, Result } from "../protocol";
import { BinaryMessage, PartedMessages } from "./binary_message";

/** The engine refused a request. */
export class Refusal extends Error {
  constructor(readonly error: EngineError) {
    super(error.problem);
  }
}

/** The connection was lost before the engine answered. */
export class LostConnection extends Error {}

export type Link = "connecting" | "open" | "lost";

interface Listeners {
  event: (event: EngineEvent) => void;
  binary: (message: BinaryMessage) => void;
  link: (link: Link) => void;
}

/** A reply without the fields that belong to another request. */
export type Outcome = Exclude<Result, { model: unknown }>;

/**
 * The WebSocket of the page: requests and their replies, events and binary messages. A lost connection is retried until
 * the engine answers. The document is then no longer open there, and `link` says so.
 */
export class Connection {
  private socket: WebSocket | undefined;
  private last = 0;
  private readonly waiting = new Map<Id, { resolve: (result: Outcome) => void; reject: (why: Refusal | LostConnection) => void }>();
  private retryMs = 250;
  private isClosed = false;
  private parts = new PartedMessages();

  constructor(
    private readonly address: string,
    private readonly listeners: Listeners,
  ) {}

  open(): void {
    this.listeners.link("connecting");
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.retryMs = 250;
      this.parts = new PartedMessages();
      this.listeners.link("open");
    };
    socket.onmessage = ({ data }) => this.receive(data as string | ArrayBuffer);
    socket.onclose = () => this.lose();
    this.socket = socket;
  }

  /**
   * Sends a request and resolves with the answer. Rejects with `Refusal` if the engine refuses, and with
   * `LostConnection` if the connection is lost.
   */
  request(request: PageRequest): Promise<Outcome> {
    return this.send(request).answer;
  }

  /** Like `request`, but also returns the id by which the request can be cancelled. */
  send(request: PageRequest): { id: Id; answer: Promise<Outcome> } {
    const id = ++this.last;
    const answer = new Promise<Outcome>((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) {
        reject(new LostConnection());
        return;
      }
      this.waiting.set(id, { resolve, reject });
      this.socket.send(JSON.stringify({ id, ...request }));
    });
    return { id, answer };
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data !== "string") {
      const bytes = this.parts.take(data);
      if (bytes !== undefined) this.listeners.binary(BinaryMessage.parse(bytes));
      return;
    }
    const message = JSON.parse(data) as Reply | EngineEvent;
    if (!("re" in message)) {
      this.listeners.event(message);
      return;
    }
    const asked = message.re === null ? undefined : this.waiting.get(message.re);
    if (asked === undefined || message.re === null) return;
    this.waiting.delete(message.re);
    if (message.error !== undefined) asked.reject(new Refusal(message.error));
    else asked.resolve((message.result ?? {}) as Outcome);
  }

  /** Closes the connection for good. */
  close(): void {
    this.isClosed = true;
    this.socket?.close();
  }

  private lose(): void {
    if (this.isClosed) return;
    for (const { reject } of this.waiting.values()) reject(new LostConnection());
    this.waiting.clear();
    this.listeners.link("lost");
    setTimeout(() => this.open(), this.retryMs);
    this.retryMs = Math.min(4000, 2 * this.retryMs);
  }
}
