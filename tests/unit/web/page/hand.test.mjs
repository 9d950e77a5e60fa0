// The rules of the hand, each in simulated time.

import assert from "node:assert/strict";
import { test } from "node:test";

import { EVENT_FRESH, IDLE, LINK_LOST, MOST_READINGS, STALLED } from "../../../../services/giraff_web/page/hand.js";
import { TICK, page, types } from "./pages.mjs";

const EASE = 0.001;
/** s between two states as the service sends them. */
const STATE = 0.04;

test("a touch that is held asks in each frame, the first time nothing", () => {
  const p = page();
  p.down();
  p.move(0, -200);
  p.frames(3);
  assert.deepEqual(p.said.map((wish) => wish.forward), [0, 1, 1]);
  assert.deepEqual(p.said.map((wish) => wish.hold), [1, 1, 1]);
  assert.deepEqual(p.said.map((wish) => wish.n), [0, 1, 2]);
  assert.deepEqual(p.last.tick, TICK(p.states));
});

test("wishes come from frames alone", () => {
  const p = page();
  p.down();
  p.move(0, -200);
  p.hand.onLook(p.now);
  p.state();
  assert.deepEqual(p.said, []);
});

test("up is forward, left is left, in both axes at once", () => {
  const p = page();
  p.down();
  p.frame();
  p.move(-200, 200);
  p.frame();
  assert.deepEqual([p.last.forward, p.last.left], [-1, 1]);
});

test("the pad's dead zone asks nothing, and 40 % of its smaller side asks all", () => {
  const p = page();
  p.down();
  p.frame();
  for (const [moved, asked] of [[0, 0], [20, 0], [50, 0.5], [80, 1], [500, 1]]) {
    p.move(0, -moved);
    p.frame();
    assert.ok(Math.abs(p.last.forward - asked) < 1e-9, `${moved}: ${p.last.forward}`);
  }
});

test("wherever the finger lands is the middle", () => {
  const p = page();
  p.down({ x: 17, y: 181 });
  p.frames(2);
  assert.deepEqual([p.last.forward, p.last.left], [0, 0]);
});

test("the finger's lifting ends the hold at once, not in a frame", () => {
  const p = page();
  p.down();
  p.frames(2);
  p.hand.onPointerUp(1);
  assert.deepEqual(p.last, { type: "let_go", n: 2, why: "finger" });
});

const ends = {
  cancelled: (p) => p.hand.onPointerLost(1, false),
  focus: (p) => p.hand.onFocused(false),
  hidden: (p) => p.hand.onVisible(false),
  left: (p) => p.hand.onLeft(),
  turned: (p) => p.hand.onTurned(),
};

for (const [why, end] of Object.entries(ends)) {
  test(`${why} ends the hold, and the finger that still lies there moves nothing`, () => {
    const p = page();
    p.down();
    p.frames(2);
    end(p);
    assert.deepEqual([p.last.type, p.last.why], ["let_go", why]);
    p.hand.onFocused(true);
    p.hand.onVisible(true);
    p.move(0, -200);
    p.frames(30);
    assert.equal(p.hand.hold, 0);
    assert.ok(p.said.slice(3).every((wish) => wish.hold === 0 && wish.forward === 0));
    p.hand.onPointerUp(1);
    p.down();
    p.frame();
    assert.deepEqual([p.last.hold, p.last.forward], [2, 0]);
  });
}

test("a lost capture is a cancelled one, and its finger still lies there", () => {
  const p = page();
  p.down();
  p.frame();
  p.hand.onPointerLost(1, true);
  assert.equal(p.last.why, "cancelled");
  assert.equal(p.down({ id: 2, primary: false }), false);
});

test("a turned angle ends the hold as well", () => {
  const p = page();
  p.down();
  p.frame();
  p.hand.onAngle(90);
  assert.equal(p.last.why, "turned");
  p.hand.onAngle(-90);
  assert.equal(p.hand.angle, 270);
});

test("1 s without an event ends the hold", () => {
  const p = page();
  p.down();
  p.frames(Math.floor(IDLE * 60));
  assert.equal(p.hand.hold, 1);
  p.frames(2);
  assert.deepEqual([p.hand.hold, p.said.at(-1).why ?? p.said.at(-2).why], [0, "idle"]);
});

test("a motion event is a sign of life of the pad, too", () => {
  const p = page();
  p.down();
  for (let frame = 0; frame < 200; frame += 1) {
    p.hand.onMotion(0, 0, 9.8, p.now, p.now);
    p.frame();
  }
  assert.equal(p.hand.hold, 1);
  assert.deepEqual(p.last.readings, []);
});

test("an event that was queued for too long is none", () => {
  const p = page();
  const old = EVENT_FRESH + EASE;
  assert.equal(p.down({ when: p.now - old }), false);
  p.hand.onPointerUp(1);
  assert.equal(p.down({ when: p.now - EVENT_FRESH + EASE }), true);
  p.frame();
  p.hand.onPointerMove(1, 100, -100, p.now - old, p.now);
  p.frame();
  assert.equal(p.last.forward, 0);
  assert.equal(p.hand.onMotion(0, 0, 9.8, p.now - old, p.now), false);
  assert.equal(p.hand.onMotion(0, 0, 9.8, p.now + old, p.now), false, "nor is one of the future");
});

test("a touch or a key that comes too late begins nothing, and the page says why", () => {
  const late = { when: page().now - EVENT_FRESH - EASE };
  for (const [input, begin] of [["pad", (p) => p.down(late)], ["keys", (p) => p.press("KeyW", late)]]) {
    const p = page({ input });
    begin(p);
    assert.deepEqual([p.hand.hold, p.hand.ended], [0, "stalled"]);
  }
  const p = page({ input: "keys" });
  p.press("KeyW");
  p.press("KeyA", late);
  assert.deepEqual([p.hand.hold, p.hand.ended], [1, ""], "a hold in force goes on");
});

test("queued events do not keep a hold alive", () => {
  const p = page();
  p.down();
  for (let frame = 0; frame < 63; frame += 1) {
    p.hand.onPointerMove(1, 100, 0, p.now - EVENT_FRESH - EASE, p.now);
    p.frame();
  }
  assert.equal(p.hand.hold, 0);
});

test("a page that stood still for 0.4 s has stopped, whichever comes first after it", () => {
  for (const first of ["onFrame", "onLook"]) {
    const p = page();
    p.down();
    p.frames(3);
    p.hand.onLook(p.now);
    p.now += 0.4;
    p.state();
    p.move(0, -100);
    p.hand[first](p.now);
    assert.equal(p.hand.hold, 0, first);
    assert.ok(p.said.some((message) => message.why === "stalled"));
    assert.ok(p.said.every((message) => !message.forward), first);
  }
});

test("frames that stop while the timer runs on are a stall", () => {
  const p = page();
  p.down();
  p.frames(3);
  for (let look = 0; look < 4; look += 1) {
    p.now += 0.1;
    p.state();
    p.move(0, 0);
    p.hand.onLook(p.now);
  }
  assert.equal(p.last.why, "stalled");
});

test("a timer that stands still while frames come is a stall", () => {
  const p = page();
  p.down();
  p.hand.onLook(p.now);
  p.frames(Math.ceil(STALLED * 60) + 1);
  p.hand.onLook(p.now);
  assert.equal(p.last.why, "stalled");
});

test("a gap just below the bound is none", () => {
  const p = page();
  p.down();
  p.frames(3);
  p.now += STALLED - EASE;
  p.state();
  p.hand.onFrame(p.now);
  assert.equal(p.hand.hold, 1);
});

test("0.5 s without a state: no wishes, and the hold ends without a word", () => {
  const p = page();
  p.down();
  p.frame();
  const until = p.now + LINK_LOST + 0.1;
  while (p.now < until) {
    p.move(0, -200);
    p.frame({ states: false });
  }
  assert.equal(p.hand.hold, 0);
  assert.ok(types(p).every((type) => type === "wish"));
  const count = p.said.length;
  p.frames(30, { states: false });
  assert.equal(p.said.length, count);
  p.frames(30);
  assert.ok(p.said.slice(count).every((wish) => wish.hold === 0));
});

for (const [what, cut] of [
  ["a cut", (p) => p.hand.onCut()],
  ["a refusal", (p) => p.hand.onRefused()],
  ["the right to drive that is gone", (p) => p.hand.onMayDrive(false)],
]) {
  test(`${what} ends the hold without a word, until the finger is put down anew`, () => {
    const p = page();
    p.down();
    p.frame();
    cut(p);
    assert.deepEqual(types(p), ["wish"]);
    p.hand.onMayDrive(true);
    p.move(0, -200);
    p.frames(10);
    assert.ok(p.said.slice(1).every((wish) => wish.hold === 0));
    p.hand.onPointerUp(1);
    p.state();
    assert.equal(p.down(), true);
  });
}

test("a page without the right to drive asks nothing", () => {
  const p = page({ may: false });
  assert.equal(p.down(), false);
  p.frames(30);
  assert.deepEqual(p.said, []);
});

test("a page out of focus or hidden asks nothing", () => {
  for (const lose of [(p) => p.hand.onFocused(false), (p) => p.hand.onVisible(false)]) {
    const p = page();
    p.down();
    p.hand.onPointerUp(1);
    lose(p);
    p.said.length = 0;
    p.frames(30);
    assert.equal(p.down(), false);
    p.frames(3);
    assert.deepEqual(p.said, []);
  }
});

test("a second finger changes nothing", () => {
  const p = page();
  p.down();
  p.frame();
  assert.equal(p.down({ id: 2, primary: false, x: 10, y: 10 }), false);
  p.hand.onPointerMove(2, 10, -200, p.now, p.now);
  p.frame();
  assert.deepEqual([p.last.hold, p.last.forward], [1, 0]);
  p.hand.onPointerUp(2);
  p.hand.onPointerLost(2, false);
  p.frame();
  assert.equal(p.last.hold, 1);
});

test("a finger that stays when the first is lifted holds nothing", () => {
  const p = page();
  p.down();
  p.down({ id: 2, primary: false });
  p.hand.onPointerUp(1);
  p.hand.onPointerMove(2, 100, -100, p.now, p.now);
  p.frames(3);
  assert.equal(p.hand.hold, 0);
});

test("a finger that rests elsewhere on the screen does not hinder", () => {
  assert.equal(page().down({ id: 2, primary: false }), true);
});

test("the right button and the middle one hold nothing", () => {
  for (const button of [1, 2]) assert.equal(page().down({ button }), false);
});

test("the emergency stop ends the hold, here or elsewhere, and while it lasts none begins", () => {
  const here = page();
  here.down();
  here.frame();
  here.hand.onStop();
  assert.equal(here.last.why, "finger");
  const elsewhere = page();
  elsewhere.down();
  elsewhere.frame();
  elsewhere.state({ stopped: true });
  assert.equal(elsewhere.hand.hold, 0);
  const before = page();
  before.down();
  before.frames(62);
  assert.equal(before.hand.ended, "idle");
  before.state({ stopped: true });
  assert.equal(before.hand.ended, "", "what ended a hold before says nothing after it");
  elsewhere.hand.onPointerUp(1);
  assert.equal(elsewhere.down(), false);
  elsewhere.hand.onPointerUp(1);
  elsewhere.state();
  assert.equal(elsewhere.down(), true);
});

test("another input ends the hold on purpose", () => {
  const p = page();
  p.down();
  p.frame();
  p.hand.choose("keys");
  assert.equal(p.last.why, "finger");
});

test("a page that does not drive says ten times a second after its first hold that it is there", () => {
  const p = page();
  p.frames(60);
  assert.deepEqual(p.said, []);
  p.down();
  p.hand.onPointerUp(1);
  p.said.length = 0;
  p.frames(60);
  assert.ok(p.said.length >= 8 && p.said.length <= 10, String(p.said.length));
  assert.ok(p.said.every((wish) => wish.hold === 0 && wish.forward === 0));
});

test("a hand that drives and lets go is neutral at moments that arm base, on a slow screen, too", () => {
  for (const hertz of [144, 60, 30, 15]) {
    const p = page({ input: "keys", drives: true });
    p.press("KeyW");
    p.lift("KeyW");
    p.said.length = 0;
    let next = p.now;
    for (let frame = 0; frame < hertz; frame += 1) {
      p.now += 1 / hertz;
      for (; next <= p.now; next += STATE) p.state();
      p.frame({ states: false, step: 0 });
    }
    assert.ok(p.said.every((wish) => wish.hold === 0 && wish.forward === 0));
    const ticks = p.said.map((wish) => Number(BigInt(wish.tick[1]) - BigInt(TICK(0)[1])));
    const gaps = ticks.slice(1).map((tick, index) => tick - ticks[index]);
    assert.ok(Math.max(...gaps) * STATE < 0.09, `${hertz} Hz: ${gaps}`);
    assert.ok(Math.min(...gaps) > 0, `${hertz} Hz: no state is answered twice`);
    p.said.length = 0;
    p.frames(10, { states: false });
    assert.deepEqual(p.said, [], "nothing is heard, and nothing is said of it");
  }
});

test("a fast screen asks no more than a plain one", () => {
  const p = page();
  p.down();
  for (let frame = 0; frame < 144; frame += 1) {
    p.frame({ step: 1 / 144 });
    p.move(0, 0);
  }
  assert.ok(p.said.length <= 80, String(p.said.length));
});

// Tilt.

test("readings go out in each frame before any hold, with the tick of the newest", () => {
  const p = page({ input: "tilt" });
  p.hand.onMotion(1, 2, 9, p.now, p.now);
  p.hand.onMotion(2, 3, 8, p.now, p.now);
  const tick = TICK(p.states);
  p.frame(); // a newer state comes before the frame
  assert.deepEqual(p.said.length, 1);
  assert.deepEqual(p.last.tick, tick);
  assert.notDeepEqual(p.hand.tick, tick);
  assert.deepEqual(p.last.readings.map(([, x]) => x), [1, 2]);
  assert.deepEqual([p.last.hold, p.last.input], [0, "tilt"]);
  p.frame();
  assert.equal(p.said.length, 1, "nothing is said without a reading");
});

test("a tilt that is held asks in each frame, and its tick ages with its reading", () => {
  const p = page({ input: "tilt" });
  p.down();
  p.hand.onMotion(1, 2, 9, p.now, p.now);
  const tick = TICK(p.states);
  p.frames(5);
  assert.equal(p.said.length, 5);
  assert.ok(p.said.every((wish) => wish.tick[1] === tick[1] && wish.forward === 0));
});

test("of many readings the newest go out", () => {
  const p = page({ input: "tilt" });
  for (let n = 0; n < MOST_READINGS + 5; n += 1) p.hand.onMotion(n, 0, 9, p.now, p.now);
  p.frame();
  assert.equal(p.last.readings.length, MOST_READINGS);
  assert.equal(p.last.readings.at(-1)[1], MOST_READINGS + 4);
});

test("a reading that is no number is none", () => {
  const p = page({ input: "tilt" });
  assert.equal(p.hand.onMotion(NaN, 0, 9, p.now, p.now), false);
});

test("readings of the time without a link are not kept", () => {
  const p = page({ input: "tilt" });
  p.hand.onCut();
  p.hand.onMotion(1, 0, 9, p.now, p.now);
  p.frame({ states: false });
  p.frame();
  assert.deepEqual(p.said, []);
});
