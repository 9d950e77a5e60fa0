// The connection to the service: it opens again by itself, and says why it is closed.

const FIRST_WAIT = 0.25;
const LONGEST_WAIT = 1.0;
/** s after which a connection that is not made, or is silent, is given up; the first and each third may take longer. */
const PATIENCE = 1.5;
const LONG_PATIENCE = 5.0;
/** s between two looks, from which it may be this page that stood still: what has come since is still queued. */
const LATE_LOOK = 0.5;
/** ms for which the answer to a token is waited for. */
const SESSION_PATIENCE = 8000;
/** Somebody has ended this page: to connect again by itself would undo that. */
const ENDED = 4410;
/** Attempts without a single connection after which the certificate may be why. */
const SUSPICIOUS = 2;

/** Bytes that may wait to be sent, above which no wish is added. */
const MOST_WAITING = 4096;

/**
 * @typedef {object} Listener
 * @property {(message: any) => void} onMessage
 * @property {(buffer: ArrayBuffer) => void} onPicture of the camera
 * @property {() => void} onCut
 * @property {(why: string) => void} onWhy why there is no connection, or no right to drive; empty: there is
 * @property {(text: string) => void} onSession what became of the token
 * @property {() => void} onUntrusted the page loads, and no socket opens
 */

export class Link {
  /** @param {Listener} listener */
  constructor(listener) {
    this._listener = listener;
    /** @type {WebSocket | null} */
    this._socket = null;
    this._wait = FIRST_WAIT;
    this._attempts = 0;
    this._everOpen = false;
    this._heardAt = 0;
    this._givesUp = 0;
    this._lookedAt = 0;
    this._retry = 0;
    this._ended = false;
    addEventListener("online", () => this._now());
    addEventListener("hashchange", () => this._takeToken());
    addEventListener("pageshow", (event) => event.persisted && this._now());
    document.addEventListener("visibilitychange", () => document.hidden || this._now());
  }

  start() {
    this._takeToken();
  }

  get isOpen() {
    return this._socket?.readyState === WebSocket.OPEN;
  }

  /** Says nothing when there is no connection: what was meant for then is old when there is one again. */
  say(message) {
    if (!this._socket || !this.isOpen) return;
    // What waits to be sent would hold up a STOP: of wishes the next one says more.
    if (message.type === "wish" && this._socket.bufferedAmount > MOST_WAITING) return;
    this._socket.send(JSON.stringify(message));
  }

  /** Look after the connection; `now` in s. */
  look(now) {
    const socket = this._socket;
    const late = now - this._lookedAt > LATE_LOOK;
    this._lookedAt = now;
    if (!socket || document.hidden || late) {
      this._heardAt = now;
      return;
    }
    const opening = socket.readyState === WebSocket.CONNECTING && now > this._givesUp;
    const silent = socket.readyState === WebSocket.OPEN && now - this._heardAt > PATIENCE;
    if (opening || silent) this._drop("the robot's host does not answer");
  }

  async _takeToken() {
    const token = location.hash.slice(1);
    if (!token) return this._now();
    try {
      const answer = await fetch("/session", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ token }),
        signal: AbortSignal.timeout(SESSION_PATIENCE),
      });
      const said = await answer.json().catch(() => ({}));
      if (answer.status !== 429) history.replaceState(null, "", location.pathname + location.search);
      else setTimeout(() => this._takeToken(), 3000);
      if (answer.ok) this._ended = false;
      this._listener.onSession(answer.ok ? "" : said.why || `the code was not taken (${answer.status})`);
    } catch {
      setTimeout(() => this._takeToken(), LONGEST_WAIT * 1000); // no network yet: the token is kept
      return;
    }
    // The cookie goes with the next connection only.
    if (this._socket) this._drop("");
    this._now();
  }

  _now() {
    if (this._ended || (this._socket && this._socket.readyState <= WebSocket.OPEN)) return;
    clearTimeout(this._retry);
    this._connect();
  }

  _connect() {
    this._attempts += 1;
    const address = new URL("/ws", location.href);
    address.protocol = address.protocol === "http:" ? "ws:" : "wss:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this._socket = socket;
    const now = performance.now() / 1000;
    this._givesUp = now + (!this._everOpen || this._attempts % 3 === 0 ? LONG_PATIENCE : PATIENCE);
    socket.onopen = () => {
      this._everOpen = true;
      this._heardAt = performance.now() / 1000;
    };
    socket.onmessage = (event) => {
      this._heardAt = performance.now() / 1000;
      if (typeof event.data !== "string") return this._listener.onPicture(event.data);
      const message = JSON.parse(event.data);
      if (message.type === "hello") {
        this._wait = FIRST_WAIT;
        this._attempts = 0;
        this._listener.onWhy("");
      }
      this._listener.onMessage(message);
    };
    socket.onclose = (event) => this._closed(event.reason, event.code);
  }

  /** Give the socket up without waiting for its goodbye. */
  _drop(why) {
    const socket = this._socket;
    if (socket) {
      socket.onopen = socket.onmessage = socket.onclose = null;
      socket.close();
    }
    this._closed(why, 1006);
  }

  _closed(reason, code) {
    this._socket = null;
    this._listener.onCut();
    this._listener.onWhy(reason || (code === 1006 ? "" : `the connection was closed (${code})`));
    clearTimeout(this._retry);
    this._ended = code === ENDED;
    if (this._ended) return;
    this._retry = setTimeout(() => this._connect(), this._wait * 1000);
    this._wait = Math.min(LONGEST_WAIT, this._wait * 2);
    if (!this._everOpen && code === 1006 && this._attempts >= SUSPICIOUS) this._suspect();
  }

  async _suspect() {
    try {
      const answer = await fetch("/page/icon.svg", { cache: "no-store" });
      if (answer.ok && !this._everOpen) this._listener.onUntrusted();
    } catch {
      // The host is not reached at all: it is not the certificate.
    }
  }
}
