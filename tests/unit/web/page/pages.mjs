// A page with a finger, in simulated time: frames of 60 Hz, states of 25 Hz and more.

import { Hand } from "../../../../services/giraff_web/page/hand.js";

export const FRAME = 1 / 60;

export const TICK = (n) => ["18446744073709551615", String(9007199254740993n + BigInt(n))];

export const types = (p) => p.said.map((message) => message.type);

class Page {
  constructor({ may = true, input = "pad", drives = false }) {
    this.now = 1000;
    this.said = [];
    this.states = 0;
    this.drives = drives;
    this.hand = new Hand((message) => this.said.push(structuredClone(message)));
    this.hand.onMayDrive(may);
    this.hand.choose(input);
    this.state();
  }

  get last() {
    return this.said.at(-1);
  }

  state({ stopped = false } = {}) {
    this.states += 1;
    this.hand.onState(TICK(this.states), stopped, this.drives, this.now);
  }

  /** A finger on a pad of 200 pixels. */
  down(touch = {}) {
    const plain = { id: 1, kind: "touch", primary: true, button: 0, x: 100, y: 100, side: 200, when: this.now };
    this.x0 = touch.x ?? 100;
    this.y0 = touch.y ?? 100;
    return this.hand.onPointerDown({ ...plain, ...touch }, this.now);
  }

  /** Pixels from where it was put, x to the right and y down. */
  move(x, y) {
    this.hand.onPointerMove(1, this.x0 + x, this.y0 + y, this.now, this.now);
  }

  press(code, { repeat = false, when = this.now } = {}) {
    return this.hand.onKeyDown(code, repeat, when, this.now);
  }

  lift(code) {
    this.hand.onKeyUp(code, this.now);
  }

  frame({ states = true, step = FRAME } = {}) {
    this.now += step;
    if (states) this.state();
    this.hand.onFrame(this.now);
  }

  frames(count, options = {}) {
    for (let frame = 0; frame < count; frame += 1) this.frame(options);
  }
}

/** @returns {Page} */
export const page = (options = {}) => new Page(options);
