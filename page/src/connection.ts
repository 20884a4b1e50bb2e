// The stream of server-sent events, opened again by itself. The browser's own way of reopening is not used: it gives up
// for good when a proxy answers with an error, and would start a recording anew instead of where it was.
import { kinds, readMessage, type Message } from './protocol';

const firstRetryMs = 500;
const lastRetryMs = 2000;

export class Connection {
  /** When a state was last heard, on the clock of performance.now(): all else may come without it, and would deceive. */
  heardMs = performance.now();
  /** Whether the stream is meant to be open. */
  wanted = false;
  /** Whether the last attempt failed or was cut off. */
  lost = false;
  /** Messages that could not be read. */
  refused = 0;
  private source: EventSource | null = null;
  private timer = 0;
  private openedMs = 0;
  private retryMs = firstRetryMs;

  /**
   * `address` is asked at each attempt, so that a recording goes on from where it is. After `silenceMs` without a state
   * the stream is opened anew: a half-open connection says nothing, neither data nor an error.
   */
  constructor(
    private readonly address: () => string,
    private readonly silenceMs: number,
    private readonly receive: (message: Message) => void,
    private readonly reopened: () => void,
  ) {}

  open(): void {
    this.close();
    this.wanted = true;
    this.heardMs = performance.now();
    this.connect();
  }

  close(): void {
    this.wanted = false;
    this.lost = false;
    window.clearTimeout(this.timer);
    this.source?.close();
    this.source = null;
  }

  /** To be called a few times a second. */
  watch(nowMs: number): void {
    if (this.source && nowMs - Math.max(this.heardMs, this.openedMs) > this.silenceMs) this.retry();
  }

  private connect(): void {
    const source = new EventSource(this.address());
    this.source = source;
    this.openedMs = performance.now();
    for (const kind of kinds) {
      source.addEventListener(kind, (event) => {
        this.retryMs = firstRetryMs;
        if (this.lost) {
          this.lost = false;
          this.reopened();
        }
        let message: Message;
        try {
          message = readMessage(kind, (event as MessageEvent<string>).data);
        } catch {
          this.refused += 1;
          return;
        }
        if (kind === 'state') this.heardMs = performance.now();
        this.receive(message);
      });
    }
    source.onerror = () => this.retry();
  }

  private retry(): void {
    this.source?.close();
    this.source = null;
    this.lost = true;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.connect(), this.retryMs);
    this.retryMs = Math.min(2 * this.retryMs, lastRetryMs);
  }
}
