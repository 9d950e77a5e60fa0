// What is written on the page. No DOM and no clock.

/** s from which what is shown is too old to drive by. */
export const OLD = 0.5;

const ENDED = {
  cancelled: "the browser took your finger for itself",
  hidden: "the page was hidden",
  focus: "another window has the keyboard",
  turned: "the screen was turned",
  idle: "nothing moved for 1 s",
  stalled: "this page stood still for a moment",
  left: "the page was left",
  lost: "the link was lost",
  gamepad: "the gamepad is not heard, or no hand moves it",
  centre: "the stick was not centred",
};
const AGAIN = {
  tilt: "let go, then hold again",
  pad: "let go, then hold again",
  keys: "let go of the keys, then press again",
  gamepad: "let go of the shoulder buttons, centre the stick, then hold again",
};
const HOW = {
  tilt: "Hold the phone flat, put a finger on the field, then tilt",
  pad: "Put a finger on the pad and drag",
  keys: "Press an arrow key or W, A, S, D",
  gamepad: "Hold an upper shoulder button, then move the left stick",
};
const TAKE = {
  tilt: "hold the field",
  pad: "hold the pad",
  keys: "press a drive key",
  gamepad: "hold an upper shoulder button",
};
const ADDRESS = "To drive, open the address that the robot’s page service shows now.";
const SEE = "see that the robot may move";
const ARM = {
  tilt: "hold the field and keep the phone flat",
  pad: "hold the pad without dragging",
  keys: "let go of the keys",
  gamepad: "hold an upper shoulder button with the stick centred",
};

/** Who drives, by the operator's name. */
const DRIVERS = {
  demo: "The demonstration",
  joystick: "The joystick",
  keyboard: "The keyboard",
  motion: "A motion that somebody asked for",
  ros2: "A ROS 2 program",
  script: "A script",
  web: "Another page",
};
/** Words for another that drives, by the action that would take the robot from it. */
const DRIVES = { ask: "drives", take: "drives; it gives way to others" };
/** Words for the steps of an action. Others have none: the page says below how its own hand takes and arms the robot. */
const STEPS = {
  run: (command) => [`ask somebody at the robot’s computer to run \`${command}\``],
  release: (command, mayDrive) => [
    ...(command ? STEPS.run(command) : []),
    mayDrive ? "tap Release" : "release it on a page that may drive",
  ],
};
/** The guard names one of these before the reason that holds it back just now. */
const HEADS = ["forward blocked", "forward slowed", "backward blocked", "backward slowed", "turning slowed"];

const driverName = (operator) => DRIVERS[operator] ?? sentence(operator);

export const DEGREES = 180 / Math.PI;

function toDo({ remedy, action, argument }, mayDrive) {
  return [remedy, ...(STEPS[action]?.(argument, mayDrive) ?? [])].filter(Boolean).join(", then ");
}

function howToRelease({ reason }, mayDrive) {
  return toDo({ ...reason, remedy: reason.remedy || SEE, action: "release" }, mayDrive);
}

/** What is wrong and what to do about it; empty: nothing is. @param {any} trouble as a message has it */
export function line(trouble, mayDrive) {
  const { what, action, argument } = trouble;
  const drives = argument && DRIVES[action];
  const said = drives ? `${driverName(argument)} ${drives}` : what;
  return [said, toDo(trouble, mayDrive)].filter(Boolean).join("; ");
}

const known = (value) => typeof value === "number" && Number.isFinite(value);

/** Age of what is shown, s, as people read it. */
export function ageText(age) {
  return known(age) ? `${age.toFixed(1)} s` : "LOST";
}

export function driverText(state, me, mayDrive, input) {
  const free = mayDrive && !isStopped(state);
  const take = free ? ` To take over, ${TAKE[input]}.` : "";
  if (state.page && state.page === me) return "You drive.";
  if (state.device) return `${sentence(state.device)} drives.${take}`;
  if (state.operator) return `${driverName(state.operator)} drives.${take}`;
  return free ? `Nobody drives. To drive, ${TAKE[input]}.` : "Nobody drives.";
}

export function armedText(state, me, input) {
  if (state.armed === null) return "Base is not heard.";
  if (state.armed) return "Armed.";
  const mine = state.page && state.page === me && !isStopped(state);
  return mine ? `Not armed: to arm, ${ARM[input]} for a moment.` : "Not armed.";
}

/**
 * Why the robot does not drive as this page asks, in one sentence; else what to do.
 * @param {{linked: boolean, heard: boolean, closed: string, mayDrive: boolean, session: string, refused: string,
 *   ended: string, hold: number, stopping: boolean, input: import("./hand.js").Input, me: number, state: any,
 *   route?: any}} at `route`: that goes on, or has ended a while ago
 */
export function whyText(at) {
  if (!at.linked) {
    if (at.closed) return `Not connected: ${at.closed}`;
    return at.heard ? "The link is lost. The robot stops by itself; connecting again." : "Connecting to the robot.";
  }
  if (at.stopping) return "The emergency stop was asked for on this page.";
  const stopped = isStopped(at.state) && `STOPPED. ${sentence(howToRelease(at.state.stop, at.mayDrive))}.`;
  const address = at.session ? sentence(at.session).replace(/[^.]$/, "$&.") : ADDRESS;
  const route = !at.hold && routeWhy(at.route, at.mayDrive);
  if (!at.mayDrive) return `${stopped || route || "You can watch and stop."} ${address}`;
  if (stopped) return stopped;
  if (at.refused) return sentence(at.refused);
  if (route) return route;
  if (!at.hold && ENDED[at.ended]) {
    return `Not driving, since ${ENDED[at.ended]}: ${AGAIN[at.input]}.`;
  }
  if (at.state?.why.what) return sentence(line(at.state.why, at.mayDrive));
  return at.hold ? "The robot obeys." : `${HOW[at.input]}.`;
}

export const DIRECTIONS = [
  ["forward", "Forward", "m/s"],
  ["backward", "Backward", "m/s"],
  ["turn_left", "Left", "rad/s"],
  ["turn_right", "Right", "rad/s"],
];

/** Whether the emergency stop is engaged, as a state says it. */
export function isStopped(state) {
  return Boolean(state?.stop?.engaged);
}

/** Clearance of one direction as a word. The emergency stop comes first; "unknown" when the guard is not heard. */
export function clearance(state, way) {
  return isStopped(state) ? "stopped" : (state.directions?.[way]?.clearance ?? "unknown");
}

/**
 * What holds the directions back, ways of the same reason together: "Forward, left: reason; remedy."
 * @param {any} said the trouble that the page shows already
 */
export function reasons(directions, mayDrive, said = null) {
  if (!directions) return ["The guard is not heard."];
  /** @type {Map<string, string[]>} */
  const ways = new Map();
  for (const [way, label] of DIRECTIONS) {
    const reason = directions[way]?.reason;
    if (!reason?.what || HEADS.some((head) => said?.what === `${head}: ${reason.what}`)) continue;
    const text = line(reason, mayDrive);
    ways.set(text, [...(ways.get(text) ?? []), label]);
  }
  return [...ways].map(([text, labels]) => `${sentence(labels.join(", ").toLowerCase())}: ${text}.`);
}

/** What a sensor says, as a line: "Front left: 0.84 m", "Front: pushed". */
function sensorText(name, { text, reason }, mayDrive) {
  return `${sentence(name.replaceAll("_", " "))}: ${line(reason, mayDrive) || text}`;
}

/** How long ago the battery was charged, where base has seen it. */
function charged(seconds) {
  return known(seconds) ? `, charged ${(seconds / 3600).toFixed(1)} h ago` : "";
}

export function facts(state) {
  return {
    speed: known(state.speed?.[0]) ? `${fixed(state.speed[0], 2)} m/s` : "–",
    turn: known(state.speed?.[1]) ? `${fixed(state.speed[1], 1)} rad/s` : "–",
    battery: known(state.battery) ? `${state.battery.toFixed(1)} V${charged(state.since_charge)}` : "–",
    trip: known(state.round_trip) ? `${Math.round(state.round_trip * 1000)} ms` : "–",
    path: known(state.path) ? `${state.path.toFixed(1)} m` : "–",
  };
}

/** The floor plan for those who do not see it, a line each. */
export function floorLines(state, mayDrive, plan = null) {
  const lines = Object.entries(state.evidence).map(([name, view]) => sensorText(name, view, mayDrive));
  if (state.pose) lines.push(`By its wheels: ${poseText(state.pose, sd(state.covariance))}`);
  if (state.map) lines.push(mapText(state.map, mayDrive));
  const away = ({ x, y }) => Math.hypot(x - state.map.pose[0], y - state.map.pose[1]);
  const [nearest] = [...(knownPlan(state, plan)?.places ?? [])].sort((one, other) => away(one) - away(other));
  if (nearest) lines.push(`Nearest place: ${nearest.name}, ${fixed(away(nearest), 1)} m away`);
  return lines;
}

/** The floor plan, where the robot is known to be on it; else null. */
export function knownPlan({ map }, plan) {
  return map && isPlaced(map) && plan?.map === map.map ? plan : null;
}

/** Whether localization knows the place, by the sensors or because a person gave it. */
export function isPlaced(map) {
  return map.state === "localized" || map.state === "told";
}

/** A place by its name, or a point: "(3.2, 1.5)". @param {string | [number, number] | null} goal */
export function goalText(goal) {
  return Array.isArray(goal) ? `(${goal.map((metres) => fixed(metres, 1)).join(", ")})` : (goal ?? "nowhere");
}

/** Whether a route goes on, as the service tells it. */
export function goesOn(route) {
  return Boolean(route) && route.stage !== "ended";
}

/** How far a route is: "To kitchen: leg 2 of 5, 3.2 of 7.9 m". `goal`: that this page has asked for. */
export function routeText(route, goal) {
  if (!goesOn(route) || !route.legs) return `To ${goalText(goal ?? route.goal)}: asked for`;
  const { leg, legs, come, way } = route;
  return `To ${goalText(route.goal)}: leg ${Math.max(1, leg)} of ${legs}, ${fixed(come, 1)} of ${fixed(way, 1)} m`;
}

/** Why a route waits, or how it has ended; empty: there is none. */
export function routeWhy(route, mayDrive) {
  if (!route) return "";
  const [goal, why] = [goalText(route.goal), line(route.why, mayDrive)];
  if (route.outcome === "arrived") return `Arrived at ${goal}.`;
  if (!goesOn(route)) return `Not at ${goal}: ${why || route.outcome.replaceAll("_", " ")}.`;
  return why ? `${sentence(why)}.` : `Going to ${goal} for ${route.by}.`;
}

/** Where the robot is on the map, in one short line. */
export function placeText(map) {
  const state = sentence(map.state.replaceAll("_", " "));
  if (map.state === "lost") return `Lost: the place on ${map.map} is not known`;
  if (map.state === "ambiguous") return `Ambiguous: several places on ${map.map} fit`;
  if (!isPlaced(map)) return state;
  const [x, y, yaw] = map.pose;
  const heading = Math.round(yaw * DEGREES);
  const most = fixed(sd(map.covariance), 2);
  return `${state}: ${fixed(x, 2)}, ${fixed(y, 2)} m, ${heading}°, sd ${most} m, ${Math.round(map.yaw_sd * DEGREES)}°`;
}

/** The same in whole: "Localized on flat: x 1.20 m, y 3.40 m, heading 90°, sd 0.05 m, 2°". */
export function mapText(map, mayDrive) {
  const why = line(map.why, mayDrive);
  const state = `${sentence(map.state.replaceAll("_", " "))}${map.map ? ` on ${map.map}` : ""}`;
  if (!isPlaced(map)) return `${state}: ${why}`;
  const place = `${state}: ${poseText(map.pose, sd(map.covariance))}, ${Math.round(map.yaw_sd * DEGREES)}°`;
  return why ? `${place}; ${why}` : place;
}

/** Larger standard deviation of a place, m, by its covariance. */
function sd([xx, xy, yy]) {
  return Math.sqrt((xx + yy) / 2 + Math.hypot((xx - yy) / 2, xy));
}

function poseText([x, y, yaw], metres) {
  const heading = Math.round(yaw * DEGREES);
  return `x ${fixed(x, 2)} m, y ${fixed(y, 2)} m, heading ${heading}°, sd ${fixed(metres, 2)} m`;
}

/** How a robot that balances holds itself: "Stands: leans 1.2°, 3 N m". */
export function balanceText(balance) {
  const because = balance.cause && balance.posture !== "stands" ? `, because ${balance.cause}` : "";
  const lean = fixed(balance.lean * DEGREES, 1);
  return `${sentence(balance.posture)}${because}: leans ${lean}°, ${fixed(balance.torque, 0)} N m`;
}

/** Without a minus before a zero, nor numbers that jump between both. */
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}

export function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
