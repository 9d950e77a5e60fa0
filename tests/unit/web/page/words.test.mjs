// What is written on the page.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Floor, ellipse, roomPlace, steadyScale, surroundings } from "../../../../services/giraff_web/page/floor.js";
import * as words from "../../../../services/giraff_web/page/words.js";

const trouble = (what, remedy = "", action = "", argument = "") => ({ what, remedy, action, argument });
const well = trouble("");
const free = { clearance: "free", allowed: 0.6, sensor: "", reason: well };
const blocked = { clearance: "blocked", allowed: 0, sensor: "rear", reason: trouble("rear is blind", "turn away") };
const state = { page: 0, device: "", operator: "", armed: true, why: well, stop: null };
const at = {
  linked: true,
  heard: true,
  closed: "",
  mayDrive: true,
  session: "",
  refused: "",
  ended: "",
  hold: 0,
  stopping: false,
  input: "pad",
  me: 3,
  state,
};

test("an age is in tenths, and none is LOST", () => {
  assert.equal(words.ageText(0.04), "0.0 s");
  assert.equal(words.ageText(0.56), "0.6 s");
  for (const none of [null, undefined, Infinity, NaN]) assert.equal(words.ageText(none), "LOST");
});

test("why: the first of what is between the hand and the robot", () => {
  const why = (change) => words.whyText({ ...at, ...change });
  assert.match(why({ linked: false, heard: false }), /^Connecting/);
  assert.match(why({ linked: false, mayDrive: false }), /^The link is lost/);
  assert.equal(why({ linked: false, closed: "too many pages" }), "Not connected: too many pages");
  assert.match(why({ mayDrive: false }), /open the address/);
  assert.equal(why({ mayDrive: false, session: "this code was used" }), "You can watch and stop. This code was used.");
  assert.equal(why({ refused: "begin neutral", ended: "idle" }), "Begin neutral");
  assert.match(why({ ended: "stalled", state: { ...state, why: trouble("not armed") } }), /stood still.*let go/);
  assert.match(why({ ended: "focus", input: "keys" }), /let go of the keys/);
  assert.match(why({ ended: "gamepad", input: "gamepad" }), /the gamepad is not heard, or no hand moves it: let go of the shoulder buttons, centre/);
  const told = (...told) => why({ hold: 2, state: { ...state, why: trouble(...told) } });
  assert.equal(told("not armed since it fell", "", "hold_level", "0.2 s"), "Not armed since it fell");
  const gives = "held by demo (7e007ae3), which gives way to others";
  assert.equal(told(gives, "", "take", "demo"), "The demonstration drives; it gives way to others");
  const held = told("held by keyboard (7e007ae3)", "wait until it rests for 5 s", "ask", "keyboard");
  assert.equal(held, "The keyboard drives; wait until it rests for 5 s");
  assert.equal(why({ hold: 2 }), "The robot obeys.");
  assert.match(why({ ended: "finger" }), /^Put a finger/);
  assert.match(why({ stopping: true, mayDrive: false }), /emergency stop was asked/);
});

test("the emergency stop comes before every other reason, and no way is free beside it", () => {
  const why = trouble("not armed", "", "hold_level", "0.2 s");
  const stopped = { ...state, armed: false, why, stop: { engaged: true, reason: well }, directions: { forward: free } };
  for (const change of [{}, { ended: "idle" }, { refused: "begin neutral" }, { hold: 2 }]) {
    const text = words.whyText({ ...at, ...change, state: stopped });
    assert.equal(text, "STOPPED. See that the robot may move, then tap Release.");
  }
  const stuck = { ...stopped, stop: { engaged: true, reason: trouble("stuck", "free the wheel", "release") } };
  assert.equal(words.whyText({ ...at, state: stuck }), "STOPPED. Free the wheel, then tap Release.");
  const watching = words.whyText({ ...at, mayDrive: false, state: stuck });
  assert.match(watching, /^STOPPED. Free the wheel, then release it on a page that may drive. To drive, open the addr/);
  assert.match(words.whyText({ ...at, linked: false, state: stopped }), /^The link is lost/);
  assert.equal(words.clearance(stopped, "forward"), "stopped");
  assert.equal(words.clearance({ ...stopped, stop: { engaged: false } }, "forward"), "free");
  assert.equal(words.clearance({ ...stopped, stop: null }, "backward"), "unknown");
});

test("what to do is told by what the page offers: no command to release a stop, and no keys of a terminal", () => {
  for (const action of ["", "hold_level", "ask", "take", "start"]) {
    assert.equal(words.line(trouble("x", "look", action), true), "x; look", action);
  }
  const run = "ask somebody at the robot’s computer to run `giraff check wheels`";
  const line = (action, argument, mayDrive) => words.line(trouble("x", "look", action, argument), mayDrive);
  assert.equal(line("run", "giraff check wheels", true), `x; look, then ${run}`);
  assert.equal(line("release", "", true), "x; look, then tap Release");
  assert.equal(line("release", "giraff check wheels", true), `x; look, then ${run}, then tap Release`);
  const watching = `x; look, then ${run}, then release it on a page that may drive`;
  assert.equal(line("release", "giraff check wheels", false), watching);
  assert.equal(words.line(trouble("STOPPED", "", "release"), true), "STOPPED; tap Release");
  assert.equal(words.line(well, true), "");
});

test("who drives, and how to take it", () => {
  const driver = (change, may = true) => words.driverText({ ...state, ...change }, 3, may, "pad");
  assert.equal(driver({ page: 3, device: "phone", operator: "web" }), "You drive.");
  assert.equal(driver({ page: 4, device: "phone", operator: "web" }), "Phone drives. To take over, hold the pad.");
  assert.equal(driver({ operator: "joystick" }, false), "The joystick drives.");
  assert.equal(driver({ operator: "web" }, false), "Another page drives.");
  assert.equal(driver({ operator: "patrol" }, false), "Patrol drives.");
  assert.equal(driver({}), "Nobody drives. To drive, hold the pad.");
  assert.equal(driver({ stop: { engaged: true } }), "Nobody drives.");
});

test("how to arm", () => {
  const armed = (change, input) => words.armedText({ ...state, page: 3, ...change }, 3, input);
  assert.equal(armed({ armed: null }, "pad"), "Base is not heard.");
  assert.equal(armed({}, "pad"), "Armed.");
  assert.match(armed({ armed: false }, "tilt"), /keep the phone flat for a moment/);
  assert.equal(armed({ armed: false, page: 4 }, "tilt"), "Not armed.", "who drives arms");
  assert.equal(armed({ armed: false, stop: { engaged: true } }, "tilt"), "Not armed.");
});

test("reasons: those of several ways together, and none that is written already", () => {
  const directions = { forward: free, backward: blocked, turn_left: blocked, turn_right: free };
  assert.deepEqual(words.reasons(directions, true), ["Backward, left: rear is blind; turn away."]);
  assert.deepEqual(words.reasons(directions, true, trouble("backward blocked: rear is blind", "turn away")), []);
  assert.deepEqual(words.reasons(null, true), ["The guard is not heard."]);
});

test("what is not heard is no number", () => {
  const none = words.facts({ speed: null, battery: null, round_trip: null, path: null });
  assert.ok(Object.values(none).every((text) => text === "–"));
  const some = words.facts({ speed: [-0.001, 0.31], battery: 24.61, round_trip: 0.0432, path: 3.25 });
  const charged = words.facts({ battery: 24.61, since_charge: 11520 });
  assert.equal(charged.battery, "24.6 V, charged 3.2 h ago");
  assert.deepEqual(some, { speed: "0.00 m/s", turn: "0.3 rad/s", battery: "24.6 V", trip: "43 ms", path: "3.3 m" });
});

test("how a robot balances, and why where it does not", () => {
  const stands = { posture: "stands", cause: "the battery was low", lean: -0.0261, torque: -0.2 };
  assert.equal(words.balanceText(stands), "Stands: leans -1.5°, 0 N m");
  const off = words.balanceText({ ...stands, posture: "off" });
  assert.equal(off, "Off, because the battery was low: leans -1.5°, 0 N m");
});

test("the floor plan as lines", () => {
  const evidence = {
    front_left: { text: "0.84 m", reason: well },
    rear: { text: "fault", reason: trouble("no echo at all", "look at it") },
    front: { text: "pushed", reason: well },
  };
  const map = { state: "localized", map: "flat", pose: [3, 4, 0], covariance: [0.01, 0, 0.04], yaw_sd: 0.035, why: well };
  const pose = [1, -0.001, Math.PI / 2];
  const lines = words.floorLines({ evidence, directions: null, pose, covariance: [0, 0, 0.0025], map }, true);
  assert.deepEqual(lines, [
    "Front left: 0.84 m",
    "Rear: no echo at all; look at it",
    "Front: pushed",
    "By its wheels: x 1.00 m, y 0.00 m, heading 90°, sd 0.05 m",
    "Localized on flat: x 3.00 m, y 4.00 m, heading 0°, sd 0.20 m, 2°",
  ]);
  const places = [{ name: "far", x: 0, y: 0 }, { name: "desk", x: 3, y: 5.24 }];
  const last = (of, plan) => words.floorLines({ evidence, map: of }, true, plan).at(-1);
  assert.equal(last(map, { map: "flat", places }), "Nearest place: desk, 1.2 m away");
  for (const plan of [{ map: "flat", places: [] }, { map: "attic", places }]) assert.match(last(map, plan), /^Localized/);
  assert.match(last({ ...map, state: "lost" }, { map: "flat", places }), /^Lost/);
  assert.equal(words.placeText(map), "Localized: 3.00, 4.00 m, 0°, sd 0.20 m, 2°");
  const lost = { ...map, state: "lost", why: trouble("nothing fits", "drive on") };
  assert.equal(words.mapText(lost, true), "Lost on flat: nothing fits; drive on");
  assert.equal(words.placeText(lost), "Lost: the place on flat is not known");
  assert.equal(words.placeText({ ...lost, state: "ambiguous" }), "Ambiguous: several places on flat fit");
  const given = { ...map, state: "told", why: trouble("drive on") };
  assert.equal(words.placeText(given), "Told: 3.00, 4.00 m, 0°, sd 0.20 m, 2°");
  assert.equal(words.mapText(given, true), "Told on flat: x 3.00 m, y 4.00 m, heading 0°, sd 0.20 m, 2°; drive on");
});

test("the room is where the map has it, else where odometry began, else nowhere", () => {
  const room = { walls: [], map: "flat", start: [2, 1, 0] };
  const map = { state: "localized", map: "flat", odom: [1, 1, Math.PI / 2] };
  const by = (fits, known) => roomPlace({ room_fits: fits, map: known }, room)?.map((value) => value.toFixed(2));
  assert.deepEqual([by(true, null), by(false, null)], [["0.00", "0.00", "0.00"], undefined]);
  for (const other of [{ state: "lost" }, { map: "attic" }]) assert.equal(by(false, { ...map, ...other }), undefined);
  for (const state of ["localized", "told"]) assert.deepEqual(by(false, { ...map, state }), ["0.00", "-1.00", "-1.57"]);
});

test("the floor plan is drawn once the robot is known to be on it, and is another when its walls are", () => {
  const [room, plan] = [{ walls: [], map: "flat", start: [2, 1, 0] }, { map: "flat", walls: [[[0, 0], [1, 0]]] }];
  const map = { state: "localized", map: "flat", odom: [1, 1, 0] };
  assert.deepEqual(roomPlace({ map }, surroundings({ map }, room, plan)), [-1, -1, 0]);
  const grown = { ...plan, walls: [...plan.walls, [[1, 0], [1, 1]]] };
  assert.deepEqual(surroundings({ map }, null, grown).walls, grown.walls);
  for (const state of ["lost", "ambiguous"]) assert.equal(surroundings({ map: { ...map, state } }, room, plan), room);
  for (const other of [null, { ...plan, map: "attic" }, { ...plan, walls: [] }]) {
    assert.equal(surroundings({ map }, room, other), room);
  }
  assert.equal(surroundings({ map: null }, null, plan), null);
});

test("the plan keeps its scale beside a text that comes and goes, and its ellipse holds 95 %", () => {
  assert.equal(steadyScale(0, 50), 50);
  assert.equal(steadyScale(50, 70), 50);
  assert.equal(steadyScale(50, 30), 30);
  const [long, short, angle] = ellipse([0.01, 0, 0.04]);
  assert.deepEqual([long.toFixed(2), short.toFixed(2), angle], ["0.49", "0.24", Math.PI / 2]);
});

test("a place is a dot with its heading, and its name is upright below however the robot is turned", () => {
  const drawn = [];
  const none = () => {};
  const pen = { save: none, restore: none, beginPath: none, arc: (...at) => drawn.push(at.slice(0, 2)), fill: none };
  pen.moveTo = pen.lineTo = (...at) => drawn.push(at);
  pen.getTransform = () => ({ a: 0, b: -50, c: -50, d: 0, e: 200, f: 300 });
  pen.setTransform = (...at) => drawn.push(at);
  pen.strokeText = pen.fillText = (text) => drawn.push(text);
  const floor = Object.create(Floor.prototype);
  Object.assign(floor, { _pen: pen, _colours: {}, _ratio: 2, _scale: 32, _text: 10, _stroke: none });
  floor._named({ name: "desk", x: 2, y: 1, yaw: 0 });
  assert.deepEqual(drawn, [[2, 1], [3, 1], [2, 1], [2, 0, 0, 2, 150, 200], "desk", "desk"]);
});

test("what a sensor tells is drawn where it says, by its state alone", () => {
  const drawn = [];
  const none = () => {};
  const pen = { globalAlpha: 1, save: none, restore: none, beginPath: none };
  pen.moveTo = pen.lineTo = (...at) => drawn.push(at);
  pen.fill = () => drawn.push(["fill", pen.fillStyle]);
  const floor = Object.create(Floor.prototype);
  Object.assign(floor, { _pen: pen, _colours: { good: "green", bad: "red" }, _stroke: (...how) => drawn.push(how) });
  const of = (view) => {
    drawn.length = 0;
    floor._area(view);
    floor._edges(view);
    return [...drawn];
  };
  const strip = [[0, 1], [2, 3]];
  assert.deepEqual(of({ state: "free", free: [strip], seen: [] }), [...strip, ["fill", "green"], ...strip, ["green", 1]]);
  assert.deepEqual(of({ state: "fault", free: [strip], seen: [] }), [...strip, ["red", 2, [4, 4]]]);
  const point = [[5, 6]];
  const pushed = of({ state: "near", free: [], seen: [strip, point] });
  assert.deepEqual(pushed, [[0, 1], ...strip, ["red", 4], [5, 6], [5, 6], ["red", 4]]);
});
