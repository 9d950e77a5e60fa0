// The floor plan: the robot in the middle, its front up; walls, path and what the sensors see around it.

import { FINGER, goalAt } from "./route.js";
import { clearance, isPlaced, knownPlan } from "./words.js";

/** m from the robot to the nearer edge of the picture. */
const VIEW = 1.9;
/** rad to either side of the robot's nose that are drawn as its front. */
const FRONT = 0.75;
/** Colour of what a sensor tells, by its state. */
const COLOURS = { free: "good", seen: "warn", near: "bad", fault: "bad" };
/** px of the robot's radius at least, however flat the picture is. */
const SMALLEST = 16;
/** By how much another scale must differ before the plan takes it. */
const STEP = 1.5;
/** Half axis of an ellipse that holds 95 %, in standard deviations. */
const ELLIPSE_95 = Math.sqrt(5.991);
const MOST_TRAIL = 4000;
/** m between two points of the path. */
const TRAIL_STEP = 0.03;

/** The scale that a plan goes on with: a line of text that comes and goes beside it does not change it. */
export function steadyScale(scale, wanted) {
  return scale && Math.abs(Math.log(wanted / scale)) < Math.log(STEP) ? scale : wanted;
}

/** Half axes and angle of the ellipse that holds a place with 95 %. @param {[number, number, number]} covariance */
export function ellipse([xx, xy, yy]) {
  const [middle, off] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  const half = (value) => ELLIPSE_95 * Math.sqrt(Math.max(0, value));
  return [half(middle + off), half(middle - off), Math.atan2(2 * xy, xx - yy) / 2];
}

/** Where the room's start is in odom: x, y (m) and yaw (rad); null: nobody knows, and no room is drawn. */
export function roomPlace({ map, room_fits }, room) {
  if (!map || !isPlaced(map) || map.map !== room.map) return room_fits ? [0, 0, 0] : null;
  const [east, north, yaw] = room.start.map((value, axis) => value - map.odom[axis]);
  const [cos, sin] = [Math.cos(map.odom[2]), Math.sin(map.odom[2])];
  return [cos * east + sin * north, cos * north - sin * east, yaw];
}

/** What is drawn around the robot: the floor plan where it is known to be on it, else the room, which may be null. */
export function surroundings(state, room, plan) {
  const known = knownPlan(state, plan);
  return known?.walls.length ? { ...known, start: [0, 0, 0] } : room;
}

/** The path in odom; it begins anew where the pose was set from outside. */
export class Trail {
  constructor() {
    /** @type {[number, number][]} */
    this.points = [];
    /** @type {string | null} */
    this._segment = null;
  }

  onHello(hello) {
    this.points = hello.trail.map(([x, y]) => [x, y]);
    this._segment = null;
  }

  onState(state) {
    if (!state.pose) return;
    if (this._segment !== null && state.segment !== this._segment) this.points = [];
    this._segment = state.segment;
    const [x, y] = state.pose;
    const last = this.points.at(-1);
    if (last && Math.hypot(x - last[0], y - last[1]) < TRAIL_STEP) return;
    this.points.push([x, y]);
    if (this.points.length > MOST_TRAIL) this.points.shift();
  }
}

export class Floor {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this._canvas = canvas;
    this._pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this._colours = {};
    this._changed = true;
    this._ratio = 1;
    this._scale = 0;
    /** From the floor plan to the canvas's pixels; null: none is drawn. @type {DOMMatrix | null} */
    this._onPlan = null;
    new ResizeObserver(() => this._resize()).observe(canvas);
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this._readColours());
    this._readColours();
  }

  /** Something is to be drawn anew. */
  touch() {
    this._changed = true;
  }

  /** What a tap there means, px of the page; null: no floor plan is drawn. @returns {string | [number, number] | null} */
  goalAt(x, y, places) {
    const ratio = this._ratio;
    return this._onPlan && goalAt(this._onPlan, places, x * ratio, y * ratio, FINGER * ratio);
  }

  /** Draw what has changed. `linked`: it is of now. */
  draw(hello, state, trail, linked, plan = null, route = null) {
    if (!this._changed || !this._canvas.width) return;
    this._changed = false;
    this._onPlan = null;
    const pen = this._pen;
    const { width, height } = this._canvas;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    if (!hello || !state) return;
    const wanted = Math.max(Math.min(width, height) / (2 * VIEW), (SMALLEST * this._ratio) / hello.radius);
    this._scale = steadyScale(this._scale, wanted);
    // Base_link: x forward is up, y left is left.
    pen.setTransform(0, -this._scale, -this._scale, 0, width / 2, height / 2);
    pen.globalAlpha = linked ? 1 : 0.35;
    this._rings();
    const room = surroundings(state, hello.room, plan);
    const known = knownPlan(state, plan)?.walls.length ? { route, from: state.map.pose } : null;
    if (state.pose) this._around(state.pose, room, room && roomPlace(state, room), trail, known);
    const evidence = Object.values(state.evidence);
    for (const view of evidence) this._area(view);
    this._robot(hello, state);
    for (const view of evidence) this._edges(view); // some are at the robot's rim
    this._doubt(state);
  }

  _resize() {
    const ratio = devicePixelRatio || 1;
    if (Math.round(this._canvas.clientWidth * ratio) !== this._canvas.width) this._scale = 0; // the screen is another
    this._canvas.width = Math.round(this._canvas.clientWidth * ratio);
    this._canvas.height = Math.round(this._canvas.clientHeight * ratio);
    this._ratio = ratio;
    this._text = 0.8 * parseFloat(getComputedStyle(document.documentElement).fontSize);
    this._changed = true;
  }

  _readColours() {
    const style = getComputedStyle(this._canvas);
    for (const name of ["ink", "quiet", "line", "good", "warn", "bad", "accent", "card"]) {
      this._colours[name] = style.getPropertyValue(`--${name}`).trim();
    }
    this._changed = true;
  }

  /** A width on the screen, px, in the plan's metres. */
  _px(pixels) {
    return (pixels * this._ratio) / this._scale;
  }

  _stroke(colour, pixels, dash = []) {
    this._pen.strokeStyle = colour;
    this._pen.lineWidth = this._px(pixels);
    this._pen.setLineDash(dash.map((length) => this._px(length)));
    this._pen.stroke();
    this._pen.setLineDash([]);
  }

  _rings() {
    for (const radius of [0.5, 1.0, 1.5]) {
      this._pen.beginPath();
      this._pen.arc(0, 0, radius, 0, 2 * Math.PI);
      this._stroke(this._colours.line, 1);
    }
    this._label("1 m", 1.0);
  }

  /** Written at a ring's right, upright whatever the plan's axes. */
  _label(text, radius) {
    const pen = this._pen;
    pen.save();
    pen.translate(0, -radius);
    pen.transform(0, -1, -1, 0, 0, 0);
    pen.font = `${this._px(this._text)}px system-ui, sans-serif`;
    pen.fillStyle = this._colours.quiet;
    pen.fillText(text, this._px(3), this._px(4));
    pen.restore();
  }

  /** `known`: the robot's pose on the floor plan, and the route; null: nobody knows it. */
  _around([x, y, yaw], room, place, trail, known) {
    const pen = this._pen;
    pen.save();
    pen.rotate(-yaw);
    pen.translate(-x, -y);
    pen.lineJoin = pen.lineCap = "round";
    this._line(trail.points);
    this._stroke(this._colours.accent, 2);
    if (place) {
      pen.translate(place[0], place[1]);
      pen.rotate(place[2]);
      for (const wall of room.walls) {
        this._line(wall);
        this._stroke(this._colours.ink, 3);
      }
      for (const line of room.no_go ?? []) {
        this._line(line);
        this._stroke(this._colours.bad, 3, [7, 6]);
      }
      for (const named of room.places ?? []) this._named(named);
      if (known) this._onPlan = pen.getTransform();
      if (known?.route) this._route(known.route, known.from);
    }
    pen.restore();
  }

  /** What is left of a route, its goal as a ring, and a cross where something is in the way. */
  _route({ corners, end, at, stage }, from) {
    const pen = this._pen;
    if (corners.length) {
      this._line([from, ...corners]);
      this._stroke(this._colours.good, 4, [10, 7]);
    }
    if (end && stage !== "ended") {
      pen.beginPath();
      pen.arc(end[0], end[1], this._px(11), 0, 2 * Math.PI);
      this._stroke(this._colours.good, 4);
    }
    if (!at) return;
    const half = this._px(9);
    for (const side of [half, -half]) {
      this._line([[at[0] - half, at[1] - side], [at[0] + half, at[1] + side]]);
      this._stroke(this._colours.bad, 4);
    }
  }

  /** A dot with a short heading, and its name, upright however the plan is turned. */
  _named({ name, x, y, yaw }) {
    const pen = this._pen;
    const { a, b, c, d, e, f } = pen.getTransform();
    const far = this._px(16);
    this._line([[x, y], [x + far * Math.cos(yaw), y + far * Math.sin(yaw)]]);
    this._stroke(this._colours.accent, 3);
    pen.beginPath();
    pen.arc(x, y, this._px(6), 0, 2 * Math.PI);
    pen.fillStyle = this._colours.accent;
    pen.fill();
    pen.save();
    pen.setTransform(this._ratio, 0, 0, this._ratio, a * x + c * y + e, b * x + d * y + f);
    pen.font = `${this._text}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.lineWidth = 4;
    pen.strokeStyle = this._colours.card;
    pen.strokeText(name, 0, 2 * this._text);
    pen.fillStyle = this._colours.ink;
    pen.fillText(name, 0, 2 * this._text);
    pen.restore();
  }

  _line(points) {
    this._pen.beginPath();
    points.forEach(([x, y], index) => (index ? this._pen.lineTo(x, y) : this._pen.moveTo(x, y)));
  }

  /** The floor where a sensor senses nothing. */
  _area({ state, free }) {
    if (state === "fault") return;
    const pen = this._pen;
    pen.save();
    pen.globalAlpha *= state === "free" ? 0.12 : 0.22;
    pen.fillStyle = this._colours[COLOURS[state]];
    for (const strip of free) {
      this._line(strip);
      pen.fill();
    }
    pen.restore();
  }

  /** Its outline, dashed where the sensor tells nothing, and lines along what it senses. */
  _edges({ state, free, seen }) {
    const pen = this._pen;
    const colour = this._colours[COLOURS[state]];
    pen.save();
    pen.lineCap = "round"; // a line of one place is a point
    for (const strip of free) {
      this._line(strip);
      this._stroke(colour, ...(state === "fault" ? [2, [4, 4]] : [1]));
    }
    for (const strip of seen) {
      this._line([strip[0], ...strip]);
      this._stroke(colour, 4);
    }
    pen.restore();
  }

  /** Seen from above: its footprint with a filled front, its wheels, and what the guard says of each way. */
  _robot({ radius, track }, state) {
    const pen = this._pen;
    const disc = (half, colour) => {
      pen.beginPath();
      pen.arc(0, 0, radius, -half, half);
      pen.fillStyle = colour;
      pen.fill();
    };
    disc(Math.PI, this._colours.card);
    disc(FRONT, this._colours.accent);
    pen.beginPath();
    pen.arc(0, 0, radius, 0, 2 * Math.PI);
    this._stroke(this._colours.ink, 2.5);
    pen.fillStyle = this._colours.ink;
    for (const side of [track / 2, -track / 2]) pen.fillRect(-radius / 3, side - radius / 12, radius / 1.5, radius / 6);
    pen.beginPath();
    pen.moveTo(radius * 0.5, 0);
    pen.lineTo(-radius * 0.1, radius * 0.3);
    pen.lineTo(-radius * 0.1, -radius * 0.3);
    pen.closePath();
    pen.fill();
    const ways = [
      ["forward", 0],
      ["turn_left", Math.PI / 2],
      ["backward", Math.PI],
      ["turn_right", -Math.PI / 2],
    ];
    for (const [way, angle] of ways) this._way(clearance(state, way), angle, radius);
  }

  /** Where the robot is with 95 %: on the map where localization says so, else by its wheels. */
  _doubt({ map, pose, covariance }) {
    const [yaw, of] = map && isPlaced(map) ? [map.pose[2], map.covariance] : [pose?.[2], covariance];
    if (!of) return;
    const [long, short, angle] = ellipse(of);
    this._pen.beginPath();
    this._pen.ellipse(0, 0, long, short, angle - yaw, 0, 2 * Math.PI);
    this._stroke(this._colours.good, 2, [6, 4]);
  }

  /** An arrow where the guard lets the robot go, a bar where it does not. */
  _way(word, angle, radius) {
    const pen = this._pen;
    pen.save();
    pen.rotate(angle);
    const [from, half] = [radius + 0.06, 0.1];
    pen.beginPath();
    if (word === "free" || word === "slow" || word === "creep") {
      pen.moveTo(from + 0.13, 0);
      pen.lineTo(from, half);
      pen.lineTo(from, -half);
      pen.closePath();
      pen.fillStyle = word === "free" ? this._colours.good : this._colours.warn;
      pen.fill();
    } else {
      pen.moveTo(from, half * 1.5);
      pen.lineTo(from, -half * 1.5);
      this._stroke(word === "unknown" ? this._colours.quiet : this._colours.bad, 5);
    }
    pen.restore();
  }
}
