// What the page is made of, wired together.

import { Balance } from "./balance.js";
import { Floor, Trail } from "./floor.js";
import * as gamepad from "./gamepad.js";
import { Hand, isFresh } from "./hand.js";
import * as keys from "./keys.js";
import { Link } from "./link.js";
import { Others } from "./others.js";
import * as pad from "./pad.js";
import { Panel, byId, write } from "./panel.js";
import { Picture } from "./picture.js";
import { Question, StopButton } from "./question.js";
import { RouteBar, RouteHand } from "./route.js";
import { Motion, screenAngle } from "./tilt.js";
import { isStopped, line } from "./words.js";

const clock = () => performance.now() / 1000;
/** ms between two looks of the timer. */
const LOOK = 100;
/** s for which a refusal is shown after the service no longer says it. */
const REFUSAL = 6;
const modes = ["tilt", "pad", "keys", "gamepad"];

const at = {
  hello: /** @type {any} */ (null),
  plan: /** @type {any} */ (null),
  state: /** @type {any} */ (null),
  route: /** @type {any} */ (null),
  arrived: -Infinity,
  linked: false,
  heard: false,
  closed: "",
  session: "",
  refused: "",
  refusedUntil: Infinity,
  mayDrive: false,
  me: 0,
  hold: 0,
  stopping: false,
  ended: "",
  input: /** @type {import("./hand.js").Input} */ ("pad"),
};

/** Something has changed that the next frame shows; what only grows older waits for the timer's look. */
let changed = true;

const link = new Link({ onMessage, onPicture: (buffer) => picture.onPicture(buffer), onCut, onWhy, onSession, onUntrusted });
const hand = new Hand((message) => link.say(message));
const motion = new Motion(hand, clock);
const panel = new Panel();
const others = new Others((page) => link.say({ type: "end", page }));
const floor = new Floor(byId("floor"));
const trail = new Trail();
const balance = new Balance();
const picture = new Picture((message) => link.say(message));
const stop = new StopButton(clock, {
  say: (off) => {
    hand.onStop();
    link.say({ type: "stop", off });
    routes.end();
    fetch(off ? "/stop?off" : "/stop", { method: "POST", keepalive: true }).catch(() => {});
  },
});
const routes = new RouteHand((message) => link.say(message));
const routeBar = new RouteBar(routes, {
  go: (when) => {
    if (isFresh(when, clock()) && hand.isLinked(clock())) routes.go(hand.tick);
    changed = true;
  },
});
const gamepads = new gamepad.Gamepads(hand, stop);
const question = new Question({
  release: (latch, when) => {
    if (!isFresh(when, clock()) || !hand.isLinked(clock())) {
      stop.note("The release was not sent, since this page stood still or the link is lost: tap again.", REFUSAL);
      return;
    }
    link.say({ type: "reset", id: latch.id, engaged_ns: latch.engaged_ns, tick: hand.tick });
  },
});

function onMessage(message) {
  const now = clock();
  changed = true;
  if (message.type === "hello") {
    at.hello = message;
    at.plan = at.route = null;
    at.me = message.page;
    at.mayDrive = message.may_drive;
    if (message.may_drive) at.session = "";
    hand.onMayDrive(message.may_drive);
    trail.onHello(message);
    picture.onHello();
    floor.touch();
  } else if (message.type === "state") {
    buzz(message);
    at.state = message;
    at.arrived = now;
    at.heard = true;
    hand.onState(message.tick, Boolean(message.stop?.engaged), message.page === at.me, now);
    stop.onState(message, at.mayDrive);
    trail.onState(message);
    balance.onState(message, now);
    picture.onState(message, now);
    floor.touch();
    link.say({ type: "seen", n: message.n });
  } else if (message.type === "plan") {
    at.plan = message;
    floor.touch();
  } else if (message.type === "route") {
    at.route = message.stage === "idle" ? null : message;
    routes.onRoute(message, at.me);
    floor.touch();
  } else if (message.type === "pages") {
    others.onPages(message.pages, at.me);
  } else if (message.type === "looking") {
    picture.onLooking(message);
  } else if (message.type === "refused" && message.route) {
    if (routes.onOver()) refuse(message.why, now + REFUSAL);
  } else if (message.type === "refused") {
    if (message.why.what) {
      hand.onRefused();
      refuse(message.why, Infinity);
    } else at.refusedUntil = now + REFUSAL;
  }
}

function refuse(why, until) {
  at.refused = line(why, at.mayDrive);
  at.refusedUntil = until;
}

/** The robot, driven from here, has come upon what holds it. */
function buzz(state) {
  const mine = hand.hold && state.page && state.page === at.me;
  if (mine && state.why.what && at.state && !at.state.why.what) navigator.vibrate?.(60);
}

function onCut() {
  hand.onCut();
  routes.onCut();
  picture.end("the link was lost");
  floor.touch();
}

function onWhy(why) {
  at.closed = why;
}

function onSession(why) {
  at.session = why;
}

function onUntrusted() {
  byId("trust").hidden = false;
}

/** @type {WakeLockSentinel | null} */
let awake = null;
let wakes = false;

/** Keep the screen on while the robot is driven from here. */
async function wake(held) {
  if (held === wakes || !navigator.wakeLock) return;
  wakes = held;
  if (held) awake = await navigator.wakeLock.request("screen").catch(() => null);
  if (!wakes) await awake?.release().catch(() => {}); // also when it was let go before the answer came
}

function look() {
  const now = clock();
  hand.onLook(now);
  link.look(now);
  stop.look(now);
  draw(now);
}

function frame() {
  const now = clock();
  const pads = [...(navigator.getGamepads?.() ?? [])];
  if (pads.some(Boolean)) byId("mode-gamepad").hidden = false; // it stays: what was chosen does not go
  gamepads.onFrame(pads, now);
  hand.onFrame(now);
  if (hand.hold) routes.end();
  routes.onFrame(hand.tick);
  if (changed || hand.hold !== at.hold || picture.hasAged(now)) draw(now);
  floor.draw(at.hello, at.state, trail, at.linked, at.plan, at.route);
  const field = byId(at.input);
  if (at.input === "keys") keys.draw(field, hand);
  else if (at.input === "gamepad") gamepad.draw(field, hand, pads);
  else pad.draw(field, field.querySelector(".ring"), field.querySelector(".knob"), hand);
  requestAnimationFrame(frame);
}

function draw(now) {
  changed = false;
  const linked = link.isOpen && hand.isLinked(now);
  if (linked !== at.linked) floor.touch();
  if (linked) byId("trust").hidden = true;
  at.linked = linked;
  at.hold = hand.hold;
  at.stopping = stop.isOpen;
  at.ended = hand.ended;
  if (hand.hold || now > at.refusedUntil || isStopped(at.state)) at.refused = "";
  wake(hand.hold > 0);
  panel.draw(at, now);
  routeBar.draw(at);
  others.draw(at);
  balance.draw(at.state, linked, now);
  picture.draw(at, now);
  stop.draw(now, linked);
  question.draw(at.state?.stop, at.mayDrive, linked);
}

/** @param {import("./hand.js").Input} input */
async function choose(input) {
  show(input);
  write(byId("input-note"), "");
  if (input === "tilt") {
    const why = await motion.open();
    if (!why || at.input !== "tilt") return;
    write(byId("input-note"), why);
    show("pad");
  }
  // Arrow keys on the choice itself would only wander along it.
  if (at.input === "keys") byId("keys").focus({ preventScroll: true });
}

function show(input) {
  changed = true;
  hand.choose(input);
  at.input = input;
  for (const each of modes) {
    const button = byId(`mode-${each}`);
    button.setAttribute("aria-checked", String(each === input));
    button.tabIndex = each === input ? 0 : -1;
    byId(each).hidden = each !== input;
  }
}

modes.forEach((mode) => {
  const button = byId(`mode-${mode}`);
  button.addEventListener("click", () => choose(/** @type {any} */ (mode)));
  button.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const there = modes.filter((each) => !byId(`mode-${each}`).hidden);
    byId(`mode-${there.at((there.indexOf(mode) + step) % there.length)}`).focus();
  });
});

pad.listen(byId("pad"), hand, clock);
pad.listen(byId("tilt"), hand, clock);
keys.listen(hand, stop, clock);
document.addEventListener("visibilitychange", () => {
  hand.onVisible(!document.hidden);
  if (!document.hidden) return;
  picture.end("the page was hidden");
  routes.end();
});
addEventListener("focus", () => hand.onFocused(true));
addEventListener("blur", () => {
  hand.onFocused(false);
  routes.end();
  stop.letGo(); // where a key is let go then is not heard
});
addEventListener("pagehide", () => {
  hand.onLeft();
  routes.end();
});
// Where a picture fills the screen, the plan is not there; a finger that scrolls is no click.
byId("floor").addEventListener("click", (event) => {
  const goal = RouteBar.mayAsk(at) ? floor.goalAt(event.offsetX, event.offsetY, at.plan.places) : null;
  if (goal !== null) routes.onTap(goal);
  changed = true;
});
const onTurn = () => {
  hand.onTurned();
  hand.onAngle(screenAngle());
};
if (screen.orientation) screen.orientation.addEventListener("change", onTurn);
else addEventListener("orientationchange", onTurn);

hand.onVisible(!document.hidden);
hand.onFocused(document.hasFocus());
hand.onAngle(screenAngle());
show(matchMedia("(pointer: coarse)").matches ? "pad" : "keys");
setInterval(look, LOOK);
requestAnimationFrame(frame);
link.start();
