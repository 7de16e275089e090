const kFirstDelayMs = 500;
const kLongestDelayMs = 8000;
const kPingEveryMs = 10000;
const kPongWithinMs = 8000;

/** Splits a binary message: u32 little-endian header length, JSON header, payload. */
export function parseFrame(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { header, payload: new Uint8Array(buffer, 4 + length) };
}

/**
 * The WebSocket to a session. Opens itself again when it is lost, later after each failure.
 * Events: 'status' {state: connecting | open | waiting | ended, seconds, text}, 'message' (parsed JSON) and
 * 'frame' {header, payload, bytes}, each as event.detail.
 */
export class Connection extends EventTarget {
  #url; // () => the stream's
  #socket = null;
  #failures = 0;
  #retryTimer = 0;
  #pingSent = 0; // when the ping was sent that waits for its pong; 0: none

  constructor(url) {
    super();
    this.#url = url;
    setInterval(() => this.#ping(), kPingEveryMs / 2);
    addEventListener('online', () => this.#retryNow());
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.#retryNow();
    });
  }

  open() {
    clearTimeout(this.#retryTimer);
    this.#retryTimer = 0;
    this.#pingSent = 0;
    this.#tell('status', { state: 'connecting', again: this.#failures > 0 });
    const socket = new WebSocket(this.#url());
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onmessage = (event) => this.#receive(event.data);
    socket.onclose = () => this.#lost(socket);
  }

  /** For good: it does not open itself again. */
  end(text) {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
    this.#tell('status', { state: 'ended', text });
  }

  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /** False when the connection is not open: state is sent again after the next welcome. */
  send(message) {
    if (!this.isOpen) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  #receive(data) {
    if (typeof data !== 'string') {
      this.#tell('frame', { ...parseFrame(data), bytes: data.byteLength });
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'pong') {
      this.#pingSent = 0;
      return;
    }
    if (message.type === 'welcome') {
      this.#failures = 0;
      this.#tell('status', { state: 'open' });
    }
    this.#tell('message', message);
  }

  #lost(socket) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    const delay = Math.min(kLongestDelayMs, kFirstDelayMs * 2 ** this.#failures);
    this.#failures += 1;
    const jittered = delay * (0.75 + 0.5 * Math.random()); // so that all clients do not come at once
    this.#tell('status', { state: 'waiting', seconds: jittered / 1000 });
    this.#retryTimer = setTimeout(() => this.open(), jittered);
  }

  #retryNow() {
    if (this.#retryTimer) this.open();
  }

  /** A server that vanished without a word is noticed by the pong that does not come. */
  #ping() {
    if (!this.isOpen) return;
    const now = performance.now();
    if (this.#pingSent && now - this.#pingSent > kPongWithinMs) {
      const socket = this.#socket;
      socket.onmessage = null;
      socket.close();
      this.#lost(socket);
    } else if (!this.#pingSent) {
      this.#pingSent = now;
      this.send({ type: 'ping', id: String(Math.round(now)) });
    }
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
