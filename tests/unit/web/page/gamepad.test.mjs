// Gamepads, in simulated time: each frame looks at them, then the hand has its own.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Gamepads, SWAPS, padText, read, stickShare } from "../../../../services/giraff_web/page/gamepad.js";
import { EVENT_FRESH, IDLE } from "../../../../services/giraff_web/page/hand.js";
import { page } from "./pages.mjs";

const [BOTTOM, RIGHT, LEFT, TOP, LB, RB, OTHER] = [0, 1, 2, 3, 4, 5, 9];
const BUTTONS = 17;
const TRIGGER = 6;
const PLAIN = { index: 0, id: "Plain", mapping: "standard", connected: true };

/** A gamepad as a browser tells of it: x to the right, y down. */
const pad = ({ down = [], x = 0, y = 0, other = 0, beyond = [], trigger = 0, ...named } = {}) => ({
  ...PLAIN,
  axes: [x, y, other, 0, ...beyond],
  buttons: Array.from({ length: BUTTONS }, (_, n) => ({
    pressed: down.includes(n),
    value: n === TRIGGER ? trigger : Number(down.includes(n)),
  })),
  ...named,
});

/** A page beside which gamepads lie; `stops`: how often the stop was pressed. */
class Desk {
  constructor(options = {}) {
    this.p = page({ input: "gamepad", ...options });
    this.stops = 0;
    this.gamepads = new Gamepads(this.p.hand, { press: () => (this.stops += 1) });
    this.frame(pad());
  }

  get hold() {
    return this.p.hand.hold;
  }

  frame(...pads) {
    this.p.now += 1 / 60;
    this.p.state();
    this.gamepads.onFrame(pads, this.p.now);
    this.p.hand.onFrame(this.p.now);
  }

  /** So many frames of one gamepad in a hand: `other` is a stick that never lies quite still. */
  frames(count, state, trembles = true) {
    for (let frame = 0; frame < count; frame += 1) this.frame(pad({ ...state, other: trembles ? frame * 1e-4 : 0 }));
  }
}

const AHEAD = { down: [RB], y: -1 };

function driving() {
  const desk = new Desk();
  desk.frame(pad({ down: [RB] }));
  desk.frames(3, AHEAD);
  assert.deepEqual([desk.p.last.hold, desk.p.last.forward, desk.p.last.left], [1, 1, 0]);
  return desk;
}

test("a stick asks nothing in its first quarter, and never more than all", () => {
  const asked = [0, 0.25, -0.25, 0.625, -0.625, 1, 7].map(stickShare);
  assert.deepEqual(asked, [0, 0, 0, 0.5, -0.5, 1, 1]);
  assert.deepEqual(read(pad({ x: 1, y: 1 })).asks, [-1, -1], "down is backwards, right is right");
});

test("either shoulder button holds, the first wish asks nothing, and its release ends it at once", () => {
  for (const down of [[LB], [RB], [LB, RB]]) {
    const desk = new Desk();
    desk.frame(pad({ down }));
    assert.deepEqual([desk.p.last.hold, desk.p.last.forward, desk.p.last.input], [1, 0, "gamepad"]);
    desk.frame(pad({ down, x: -0.625 }));
    assert.deepEqual([desk.p.last.forward, desk.p.last.left], [0, 0.5]);
    const count = desk.p.said.length;
    desk.frame(pad({ x: -0.625 }));
    assert.deepEqual([desk.hold, desk.p.said[count].type, desk.p.said[count].why], [0, "let_go", "finger"]);
  }
});

const NO_HAND = {
  "unplugged": null,
  "not connected": pad({ ...AHEAD, connected: false }),
  "not a number": pad({ ...AHEAD, y: NaN }),
  "without axes": pad({ ...AHEAD, axes: [] }),
  "without buttons": pad({ ...AHEAD, buttons: [] }),
  "unknown to the browser": pad({ ...AHEAD, mapping: "" }),
  "another one on its place": pad({ ...AHEAD, id: "Other" }),
  "on another place": pad({ ...AHEAD, index: 1 }),
};

for (const [what, state] of Object.entries(NO_HAND)) {
  test(`a gamepad that is ${what} has lost the hand in one frame, for good`, () => {
    const desk = driving();
    const count = desk.p.said.length;
    desk.frame(state);
    assert.deepEqual([desk.hold, desk.p.said[count].type, desk.p.said[count].why], [0, "let_go", "gamepad"]);
    for (let frame = 0; frame < 9; frame += 1) desk.frame(state);
    desk.frames(9, AHEAD); // it is back, with its switch held all the time
    assert.equal(desk.hold, 0);
    assert.ok(desk.p.said.slice(count + 1).every((wish) => wish.hold === 0 && wish.forward === 0));
    desk.frames(2, { down: [] });
    desk.frame(pad({ down: [RB] }));
    assert.equal(desk.hold, 2);
  });
}

test("a stick that is off its middle begins nothing, and the page says why", () => {
  const desk = new Desk();
  desk.frames(3, { ...AHEAD, y: -0.3 });
  assert.deepEqual([desk.hold, desk.p.hand.ended], [0, "centre"]);
  desk.frames(3, { down: [RB] });
  assert.equal(desk.hold, 0, "nor when it is centred later: the switch is lifted first");
});

test("a switch that was down at the first look, or is pressed while the page stands still, begins nothing", () => {
  const desk = new Desk();
  desk.frame();
  desk.frames(3, { down: [RB] });
  assert.equal(desk.hold, 0);
  desk.frames(2, {});
  desk.p.now += EVENT_FRESH;
  desk.frames(3, { down: [RB] });
  assert.deepEqual([desk.hold, desk.p.hand.ended], [0, "stalled"]);
});

test("1 s in which nothing of it moves ends a hold that asks, whatever its time says or a phone beside it", () => {
  const desk = driving();
  for (let frame = 0; frame < IDLE * 60 - 2; frame += 1) {
    desk.p.hand.onMotion(0, 0, 9.8 + frame * 0.1, desk.p.now, desk.p.now);
    desk.frame(pad({ ...AHEAD, timestamp: desk.p.now }));
  }
  assert.equal(desk.hold, 1);
  desk.frames(4, AHEAD, false);
  assert.deepEqual([desk.hold, desk.p.hand.ended], [0, "idle"]);
});

test("a hand that trembles drives on, and a centred stick may rest", () => {
  const desk = driving();
  desk.frames(3 * IDLE * 60, AHEAD);
  desk.frames(4 * SWAPS * 60, { down: [RB] }, false);
  assert.equal(desk.hold, 1);
  desk.frame(pad(AHEAD));
  assert.deepEqual([desk.hold, desk.p.last.forward], [1, 1], "and is pushed again at once");
});

/** One step of an 8-bit stick. */
const STEP = 1 / 127;
/** Pairs between which a gamepad that nobody touches may swap: a stick, a trigger, and beside the edge of what asks. */
const PAIRS = [
  [{}, { y: STEP - 1 }],
  [{}, { x: STEP }],
  [{}, { other: STEP }],
  [{}, { trigger: STEP }],
  [{ y: -0.25 }, { y: -0.25 - STEP }],
  [{ y: -0.25 }, { y: -1 }],
];

test("a gamepad that only swaps between two values of one axis is no hand after 3 s, however fast or far", () => {
  assert.equal(SWAPS, 3);
  for (const pair of PAIRS) {
    for (const every of [1, 17, 50]) {
      const desk = driving();
      const states = pair.map((state) => ({ ...AHEAD, ...state }));
      const swap = (frame) => desk.frame(pad(states[Math.floor(frame / every) % 2]));
      const told = `${JSON.stringify(pair)}, each ${every} frames`;
      for (let frame = 0; frame < SWAPS * 60 - 9; frame += 1) swap(frame);
      assert.equal(desk.hold, 1, told);
      for (let frame = SWAPS * 60 - 9; frame < SWAPS * 60 + every + 9; frame += 1) swap(frame);
      assert.deepEqual([desk.hold, desk.p.hand.ended], [0, "gamepad"], told);
    }
  }
});

test("two axes that swap may be a hand, and so may one with a third value in each 3 s", () => {
  const both = ({ odd }) => (odd ? { x: STEP, y: STEP - 1 } : {});
  const third = ({ odd, frame }) => (frame % 170 ? { x: odd * STEP } : { x: -STEP });
  for (const at of [both, third]) {
    const desk = driving();
    for (let frame = 0; frame < 60 * 60; frame += 1) desk.frame(pad({ ...AHEAD, ...at({ frame, odd: frame % 2 }) }));
    assert.equal(desk.hold, 1);
  }
});

test("what is no part of the standard layout is no hand: a gyro as a further axis", () => {
  const desk = driving();
  for (let frame = 0; frame < IDLE * 60 + 4; frame += 1) desk.frame(pad({ ...AHEAD, beyond: [Math.sin(frame)] }));
  assert.deepEqual([desk.hold, desk.p.hand.ended], [0, "idle"]);
});

/** Return the axes of an 8-bit stick in a thumb that trembles at 8 to 12 Hz: `size` steps on the way `angle`. */
function thumb(way, size, angle, seconds) {
  const tremble = size * STEP * Math.sin(2 * Math.PI * (10 * seconds + 0.8 * Math.sin(2.3 * seconds)));
  const said = (value) => Math.max(-1, Math.min(1, Math.round(value / STEP) * STEP));
  const [x, y] = way(seconds);
  return { down: [RB], x: said(x + tremble * Math.cos(angle)), y: said(y + tremble * Math.sin(angle)) };
}

test("a thumb on an 8-bit stick loses no hold in 60 s, held with a tremor or drawn away slowly", () => {
  const ways = {
    half: () => [0, -0.6],
    "between two steps": () => [0.5 * STEP, -60.5 * STEP],
    "at the rim": () => [0.02, -1.1],
    "slowly back": (seconds) => [0, -0.9 + 0.01 * seconds],
  };
  for (const [name, way] of Object.entries(ways)) {
    for (const size of [2, 3, 4]) {
      for (const angle of [0, 0.3, Math.PI / 4, Math.PI / 2]) {
        if (name === "at the rim" && angle === Math.PI / 2) continue; // there the stick says nothing of it
        const desk = driving();
        for (let frame = 0; frame < 60 * 60; frame += 1) desk.frame(pad(thumb(way, size, angle, frame / 60)));
        assert.equal(desk.hold, 1, `${name}, ${size} steps at ${angle}: ${desk.p.hand.ended}`);
      }
    }
  }
});

test("what ends every hold ends this one: out of focus, hidden, stopped; the switch is lifted first", () => {
  for (const end of [
    (hand) => [hand.onFocused(false), hand.onFocused(true)],
    (hand) => [hand.onVisible(false), hand.onVisible(true)],
    (hand) => hand.onStop(),
  ]) {
    const desk = driving();
    end(desk.p.hand);
    desk.frames(9, AHEAD);
    assert.equal(desk.hold, 0);
  }
});

test("of two gamepads only the one whose switch went down first drives", () => {
  const desk = new Desk();
  const [one, other] = [(state) => pad(state), (state) => pad({ ...state, index: 1, down: [LB] })];
  desk.frame(one(), pad({ index: 1 }));
  desk.frame(one(), other());
  desk.frame(one({ down: [RB] }), other());
  desk.frame(one({ down: [RB], y: -1 }), other());
  assert.deepEqual([desk.p.last.hold, desk.p.last.forward], [1, 0]);
  desk.frame(one({ down: [RB] }), pad({ index: 1 }));
  desk.frame(one({ down: [RB], y: -1 }), pad({ index: 1 }));
  assert.equal(desk.hold, 0);
});

test("a finger asks what it asks, whatever a gamepad goes on holding", () => {
  const desk = driving();
  desk.p.hand.choose("pad");
  desk.frames(2, AHEAD);
  assert.equal(desk.p.down(), true);
  desk.frames(3, AHEAD);
  assert.deepEqual([desk.p.last.hold, desk.p.last.forward, desk.p.last.input], [2, 0, "pad"]);
  desk.frames(2, {});
  assert.equal(desk.hold, 2, "nor does its release lift the finger");
});

test("it drives only where it was chosen", () => {
  const desk = new Desk({ input: "pad" });
  desk.frame(pad({ down: [RB] }));
  desk.frames(3, AHEAD);
  assert.equal(desk.hold, 0);
});

test("each of the four buttons on the right stops at each press, also as the press by which the browser tells of it", () => {
  for (const button of [BOTTOM, RIGHT, LEFT, TOP]) {
    const desk = new Desk({ input: "keys", may: false });
    desk.frames(9, { down: [button] });
    assert.equal(desk.stops, 1, `button ${button}`);
    desk.frame();
    desk.frame(pad({ down: [button, OTHER] }));
    assert.equal(desk.stops, 2);
    desk.frame(pad({ down: [button, (button + 1) % 4] }));
    assert.equal(desk.stops, 3, "beside one that is down or stuck");
  }
});

test("the field says what to hold, or why there is no gamepad to hold", () => {
  assert.match(padText([null, pad()]), /^Hold an upper shoulder button, .* Any of the four round buttons on the right stops\.$/);
  assert.match(padText([null]), /^No gamepad is heard: plug it in/);
  assert.match(padText([pad({ mapping: "", id: "Old" })]), /does not know the buttons of Old, and none of them stops: use another/);
});

test("a stop counts beside a stick that says no number, and no hold begins while it is down", () => {
  const desk = new Desk();
  desk.frame(pad({ down: [TOP], x: NaN }));
  assert.deepEqual([desk.stops, desk.hold], [1, 0]);
  const other = new Desk();
  other.frame(pad({ down: [BOTTOM, LB] }));
  other.frame(pad({ down: [BOTTOM, LB], y: -1 }));
  assert.deepEqual([other.stops, other.hold], [1, 0]);
  other.frame(pad({ down: [LB] }));
  assert.equal(other.hold, 0, "the switch was pressed for a stop");
});
