// The drive keys, in simulated time.

import assert from "node:assert/strict";
import { test } from "node:test";

import { page } from "./pages.mjs";

const keyboard = () => page({ input: "keys" });

test("a press asks nothing in its first frame, then its way", () => {
  for (const [code, asked] of [
    ["KeyW", [1, 0]],
    ["ArrowDown", [-1, 0]],
    ["KeyA", [0, 1]],
    ["ArrowRight", [0, -1]],
  ]) {
    const p = keyboard();
    assert.equal(p.press(code), true);
    p.frame();
    assert.deepEqual([p.last.forward, p.last.left, p.last.hold, p.last.input], [0, 0, 1, "keys"]);
    p.frame();
    assert.deepEqual([p.last.forward, p.last.left], asked);
  }
});

test("several keys add up, and never to more than all", () => {
  const p = keyboard();
  p.press("KeyW");
  p.press("ArrowUp");
  p.press("KeyD");
  p.frames(2);
  assert.deepEqual([p.last.forward, p.last.left, p.last.hold], [1, -1, 1]);
  p.press("KeyS");
  p.press("KeyA");
  p.frame();
  assert.deepEqual([p.last.forward, p.last.left], [1, 0]);
  p.lift("KeyW");
  p.frame();
  assert.deepEqual([p.last.forward, p.last.left], [0, 0]);
});

test("the hold ends with the last key's lifting", () => {
  const p = keyboard();
  p.press("KeyW");
  p.press("KeyD");
  p.frames(2);
  p.lift("KeyW");
  assert.equal(p.last.type, "wish");
  p.lift("KeyD");
  assert.equal(p.last.why, "finger");
  p.press("KeyW");
  p.frame();
  assert.equal(p.last.hold, 2);
});

test("a key that repeats is alive, one that does not is idle after 1 s", () => {
  const p = keyboard();
  p.press("KeyW");
  for (let frame = 0; frame < 200; frame += 1) {
    p.press("KeyW", { repeat: true });
    p.frame();
  }
  assert.equal(p.hand.hold, 1);
  p.frames(62);
  assert.equal(p.hand.hold, 0);
  assert.ok(p.said.some((message) => message.why === "idle"));
});

test("a repeat that was queued keeps nothing alive", () => {
  const p = keyboard();
  p.press("KeyW");
  for (let frame = 0; frame < 63; frame += 1) {
    p.press("KeyW", { repeat: true, when: p.now - 0.3 });
    p.frame();
  }
  assert.equal(p.hand.hold, 0);
});

test("a key that is still down after the hold has ended moves nothing until it was lifted", () => {
  const p = keyboard();
  p.press("KeyW");
  p.frames(2);
  p.hand.onFocused(false);
  p.hand.onFocused(true);
  p.press("KeyW"); // some systems say after a change of windows that it was pressed
  p.press("KeyW", { repeat: true });
  p.frames(3);
  assert.equal(p.hand.hold, 0);
  p.lift("KeyW");
  p.press("KeyW");
  p.frame();
  assert.equal(p.last.hold, 2);
});

test("a fresh key does not bring back the one that was never lifted", () => {
  const p = keyboard();
  p.press("KeyW");
  p.frame();
  p.hand.onFocused(false);
  p.hand.onFocused(true);
  p.press("KeyD");
  p.press("KeyW", { repeat: true });
  p.frames(2);
  assert.deepEqual([p.last.forward, p.last.left], [0, -1]);
});

test("a repeat begins nothing: its press was not seen here", () => {
  const p = keyboard();
  p.press("KeyW", { repeat: true });
  p.frames(3);
  assert.equal(p.hand.hold, 0);
});

test("a press that was queued begins nothing, nor do its repeats", () => {
  const p = keyboard();
  p.press("KeyW", { when: p.now - 0.3 });
  p.press("KeyW", { repeat: true });
  p.frames(3);
  assert.equal(p.hand.hold, 0);
});

test("other keys are nobody's, and no key counts beside another input", () => {
  assert.equal(keyboard().press("KeyQ"), false);
  const p = page({ input: "pad" });
  assert.equal(p.press("KeyW"), false);
  assert.equal(p.hand.hold, 0);
});

test("keys ask what they ask, wherever a finger was before", () => {
  const p = page();
  p.down();
  p.move(0, 200);
  p.frames(2);
  p.hand.onFocused(false);
  p.hand.onFocused(true);
  p.hand.choose("keys");
  p.press("KeyW");
  p.frames(2);
  assert.equal(p.last.forward, 1);
});

test("a finger holds nothing beside the keys", () => {
  assert.equal(keyboard().down(), false);
});
