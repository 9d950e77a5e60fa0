// How a robot that balances holds itself: a line, and below it, when it is opened, the last seconds as plots.

import { byId, write } from "./panel.js";
import { DEGREES, balanceText } from "./words.js";

/** s that the plots go back. */
const BACK = 10;

/** A plot's title, unit as it follows the number, and least reach (in that unit) to either side of zero; its lines: what, value, colour. */
const PLOTS = [
  {
    title: "Lean",
    unit: "°",
    reach: 2,
    lines: [
      ["accelerometer", (each) => each.accelerometer_lean * DEGREES, "quiet"],
      ["fused", (each) => each.lean * DEGREES, "accent"],
    ],
  },
  { title: "Lean rate", unit: "°/s", reach: 10, lines: [["", (each) => each.rate * DEGREES, "accent"]] },
  {
    title: "Wheels",
    unit: " m/s",
    reach: 0.5,
    lines: [
      ["left", (each) => each.wheels?.[0], "accent"],
      ["right", (each) => each.wheels?.[1], "warn"],
    ],
  },
  { title: "Torque", unit: " N m", reach: 10, lines: [["", (each) => each.torque, "accent"]] },
];

/** How far a plot reaches to either side of zero: in steps, so that it seldom changes. */
export function reachOf(values, step) {
  const most = Math.max(0, ...values.map(Math.abs));
  return step * Math.max(1, Math.ceil(most / step));
}

export class Balance {
  constructor() {
    this._panel = byId("balance");
    this._canvas = byId("balance-plots");
    /** @type {[number, any][]} when it came, s, and what was told */
    this._told = [];
  }

  /** @param {number} now s */
  onState(state, now) {
    if (!state.balance) return;
    this._told.push([now, state.balance]);
    while (this._told[0][0] < now - BACK) this._told.shift();
  }

  draw(state, linked, now) {
    this._panel.hidden = !this._told.length;
    if (this._panel.hidden) return;
    write(byId("balance-text"), linked && state.balance ? balanceText(state.balance) : "Balance is not heard");
    if (this._panel.open) this._plot(now);
  }

  _plot(now) {
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this._canvas;
    this._canvas.width = Math.round(width * ratio);
    this._canvas.height = Math.round(height * ratio);
    const pen = this._canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = "11px system-ui, sans-serif";
    const style = getComputedStyle(this._canvas);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const high = height / PLOTS.length;
    PLOTS.forEach((plot, row) => {
      const title = 14;
      const [top, middle] = [row * high, row * high + title + (high - title) / 2];
      const lines = plot.lines.map(([, value]) => this._told.map(([at, each]) => [at, value(each)]));
      const values = lines.flat().map(([, value]) => value).filter(Number.isFinite);
      const reach = reachOf(values, plot.reach);
      pen.fillStyle = colour("line");
      pen.fillRect(0, middle, width, 1);
      let x = 2;
      const say = (text, name) => {
        pen.fillStyle = colour(name);
        pen.fillText(text, x, top + 11);
        x += pen.measureText(text).width + 8;
      };
      say(`${plot.title} ±${reach}${plot.unit}`, "ink");
      plot.lines.forEach(([name, , ink], index) => {
        say(name, ink);
        pen.strokeStyle = colour(ink);
        pen.lineWidth = 1.5;
        pen.beginPath();
        for (const [at, value] of lines[index]) {
          if (!Number.isFinite(value)) continue;
          pen.lineTo(width * (1 - (now - at) / BACK), middle - (value / reach) * ((high - title) / 2 - 2));
        }
        pen.stroke();
      });
    });
  }
}
