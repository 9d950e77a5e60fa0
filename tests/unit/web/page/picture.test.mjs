// The camera's picture: how old it is, and what is said of it.

import assert from "node:assert/strict";
import { test } from "node:test";

import { RobotClock, ageText, cameraText, unpacked } from "../../../../services/giraff_web/page/picture.js";

const tick = (s) => ["7", String(s * 1e9)];

test("a picture's age is by the robot's ticks, and a state that was late makes none younger", () => {
  const clock = new RobotClock();
  assert.equal(clock.age(7, 100e9, 50), null);
  clock.onTick(tick(100), 50);
  assert.ok(Math.abs(clock.age(7, 99.9e9, 50.2) - 0.3) < 1e-6);
  clock.onTick(tick(100.1), 50.6); // half a second late, behind a picture
  assert.ok(Math.abs(clock.age(7, 100.2e9, 50.6) - 0.4) < 0.01);
  clock.onTick(tick(100.8), 50.7); // in time again
  assert.ok(Math.abs(clock.age(7, 100.2e9, 50.7) - 0.6) < 0.01);
});

test("what is of another start of base, or of no tick, has no age", () => {
  const clock = new RobotClock();
  clock.onTick(tick(100), 50);
  assert.equal(clock.age(8, 100e9, 50), null);
  assert.equal(clock.age(0, 0, 50), null);
  assert.equal(ageText(null), "of unknown age");
  assert.equal(ageText(0.81), "0.8 s old");
  clock.onTick(["8", "5000000000"], 51);
  assert.equal(clock.age(8, 5e9, 51), 0);
});

test("a message holds its number, its tick and the JPEG", async () => {
  const buffer = new ArrayBuffer(18);
  const view = new DataView(buffer);
  view.setUint32(0, 9);
  view.setUint32(4, 4294967295);
  view.setBigUint64(8, 123n);
  view.setUint16(16, 0xffd8);
  const { jpeg, ...rest } = unpacked(buffer);
  assert.deepEqual(rest, { n: 9, epoch: 4294967295, ns: 123 });
  assert.deepEqual([...new Uint8Array(await jpeg.arrayBuffer())], [0xff, 0xd8]);
});

test("every page is told who looks and what is wrong", () => {
  const why = (what, remedy = "") => ({ what, remedy, action: "", argument: "" });
  assert.equal(cameraText({ askers: [], why: why("") }, true), "The robot’s camera is off.");
  const text = cameraText({ askers: ["a", "b"], why: why("it is unplugged", "plug it in") }, true);
  assert.equal(text, "The robot’s camera is on, for a, b. It is unplugged; plug it in.");
  assert.equal(cameraText({ askers: [], why: why("it is not heard") }, true), "It is not heard.");
});
