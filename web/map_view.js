"use strict";
// The map with robots, their next moves, ways, labels and things, in a drawing 1000 pixels wide.

const HIGHEST = 640; // pixels, as page.css has it
const NUMBERED = 2; // moves of a robot that are numbered
const SCANNED = 2; // seconds for which a scan is shown
const ASK = 5000; // ms between two requests for scans

class MapView {
  constructor(parent, model) {
    this.model = model;
    this.caption = html("p", { class: "caption" });
    this.robots = html("ul", { class: "robots" });
    this.picture = svg("svg", { class: "map", role: "img", "aria-label": "Map; its contents are listed below" });
    this.scans = html("input", { type: "checkbox", id: "scans" });
    this.tools = html("label", { class: "tools", hidden: "" }, this.scans, "laser scan");
    show(parent, this.picture, this.tools, this.robots, this.caption);
  }

  /** Offer the scans of lasers; ``ask`` requests them for some seconds. */
  offerScans(ask) {
    this.tools.hidden = false;
    this.scans.addEventListener("change", () => {
      window.clearInterval(this.asking);
      if (this.scans.checked) {
        ask();
        this.asking = window.setInterval(ask, ASK);
      }
      this.draw(this.time, this.whole);
    });
  }

  /** The visible part of the floor: minimum and maximum x and y in m. */
  bounds() {
    const points = Object.values(this.model.about.labels).map(([x, y]) => [x, y]);
    const map = this.model.about.map;
    if (map) {
      const [c, s] = [Math.cos(map.yaw), Math.sin(map.yaw)];
      for (const [u, v] of [[0, 0], [map.width, 0], [0, map.height], [map.width, map.height]]) {
        points.push([map.corner[0] + c * u - s * v, map.corner[1] + s * u + c * v]);
      }
    } else {
      for (const { pose } of this.model.poses) points.push(pose.slice(0, 2));
    }
    if (!points.length) return null;
    const margin = map ? 0 : 1;
    const least = (at, some) => some.reduce((one, other) => Math.min(one, other[at]), Infinity);
    const most = (at, some) => some.reduce((one, other) => Math.max(one, other[at]), -Infinity);
    const [x0, x1] = [least(0, points) - margin, most(0, points) + margin];
    const metre = (x1 - x0) / (this.picture.clientWidth || 700); // of a pixel
    const labels = Object.values(this.model.about.labels); // with room for names and things around them
    return {
      x0: Math.min(x0, least(0, labels) - 24 * metre),
      y0: Math.min(least(1, points) - margin, least(1, labels) - 50 * metre),
      x1: Math.max(x1, most(0, labels) + 24 * metre),
      y1: Math.max(most(1, points) + margin, most(1, labels) + 64 * metre),
    };
  }

  /** Draw a moment; ``whole``: the moment is the end, and the whole way is shown without a plan. */
  draw(time, whole = false) {
    [this.time, this.whole] = [time, whole];
    const bounds = this.bounds();
    const robots = this.model.robotsAt(time);
    say(this.caption, this.words(time, robots));
    this.list(time, robots);
    if (!bounds) {
      show(this.picture);
      return;
    }
    const scale = 1000 / Math.max(bounds.x1 - bounds.x0, 0.1);
    const height = Math.max(1, (bounds.y1 - bounds.y0) * scale);
    this.at = (x, y) => [(x - bounds.x0) * scale, (bounds.y1 - y) * scale];
    this.scale = scale;
    this.unit = Math.max(1000 / (this.picture.clientWidth || 700), height / HIGHEST); // a pixel of the screen
    this.picture.setAttribute("viewBox", `0 0 1000 ${height.toFixed(1)}`);
    const moves = whole ? [] : robots.map((robot) => this.moves(time, robot));
    show(
      this.picture,
      [this.floor(), this.ways(time), this.scan(time), robots.map((robot) => this.driven(time, robot))],
      [moves.map(({ lines }) => lines), this.labels(time), robots.map((robot) => this.robotShape(time, robot)), moves.map(({ numbers }) => numbers)]
    );
  }

  floor() {
    const map = this.model.about.map;
    if (!map) return null;
    const [x, y] = this.at(...map.corner);
    const [width, height] = [map.width * this.scale, map.height * this.scale];
    const turn = `translate(${x} ${y}) rotate(${(-map.yaw * 180) / Math.PI})`;
    return svg("image", { class: "floor", href: map.image, width, height, y: -height, transform: turn, preserveAspectRatio: "none" });
  }

  line(points, name) {
    const text = points.map(([x, y]) => this.at(x, y).map((value) => value.toFixed(1)).join(",")).join(" ");
    return svg("polyline", { class: name, points: text, "stroke-width": 2 * this.unit });
  }

  /** The latest scans, as dots, if they are wanted and not older than the moment. */
  scan(time) {
    if (!this.scans.checked) return null;
    const fresh = this.model.scans.filter((one) => Math.abs(one.time - time) <= SCANNED);
    const dots = fresh.flatMap(({ points }) => points.map(([x, y]) => `M ${this.at(x, y).map((one) => one.toFixed(1)).join(" ")} h 0`));
    return dots.length ? svg("path", { class: "scan", d: dots.join(" "), "stroke-width": 4 * this.unit }) : null;
  }

  driven(time, { name, colour }) {
    return this.line(this.model.trackOf(name, time), `driven ${colour}`);
  }

  /** The next moves of a robot: the first ones with numbers, the others faint; the first along its path if that is known. */
  moves(time, { name, pose, colour }) {
    const moves = this.model.movesAt(time, name, pose);
    const legs = moves.map(({ action, from, to }, number) => {
      const path = number || name ? [] : this.model.pathAt(time);
      const end = path[path.length - 1];
      const leads = end && Math.hypot(end[0] - to[0], end[1] - to[1]) < 1;
      return { action, points: leads ? path : [from, to] };
    });
    const faint = legs.slice(NUMBERED).map(({ points }) => this.line(points, `ahead faint ${colour}`));
    const near = legs.slice(0, NUMBERED);
    return {
      lines: [faint, near.map(({ points }) => this.line(points, `ahead ${colour}`)).reverse()],
      numbers: near.map(({ action, points }, number) => this.number(number + 1, action.words, along(points, 0.6), colour)),
    };
  }

  number(number, words, [x, y], colour) {
    const [left, top] = this.at(x, y);
    const size = 13 * this.unit;
    return svg(
      "g",
      { class: `number ${colour}` },
      svg("circle", { cx: left, cy: top, r: 9 * this.unit, "stroke-width": 2 * this.unit }),
      svg("text", { x: left, y: top + size * 0.36, "font-size": size }, number),
      svg("title", {}, `${number}. ${words}`)
    );
  }

  ways(time) {
    const labels = this.model.about.labels;
    return this.model.waysAt(time).map(({ kind, labels: [from, to], text }) => {
      const name = { way: "plain", open: "good", blocked: "bad" }[kind];
      const middle = [0, 1].map((axis) => (labels[from][axis] + labels[to][axis]) / 2);
      return [
        this.line([labels[from], labels[to]], `way ${name}`),
        kind === "blocked" ? this.barrier(labels[from], labels[to]) : null,
        text ? this.text(text, middle, -14, `wayname ${name}`) : null,
      ];
    });
  }

  /** A bar across the middle of a way. */
  barrier(from, to) {
    const [[x0, y0], [x1, y1]] = [this.at(...from), this.at(...to)];
    const length = Math.hypot(x1 - x0, y1 - y0) || 1;
    const [across, down] = [((y1 - y0) / length) * 9 * this.unit, ((x0 - x1) / length) * 9 * this.unit];
    const [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2];
    return svg("line", { class: "barrier", x1: x - across, y1: y - down, x2: x + across, y2: y + down, "stroke-width": 5 * this.unit });
  }

  /** A text near a point, shortened; the whole text is its title. */
  text(words, [x, y], down, name, most = 30) {
    const [left, top] = this.at(x, y);
    const size = 13 * this.unit;
    const title = words.length > most ? svg("title", {}, words) : null;
    return svg("text", { class: name, x: left, y: top + down * this.unit, "font-size": size, "stroke-width": size / 5 }, short(words, most), title);
  }

  labels(time) {
    const lying = this.model.thingsAt(time);
    const troubles = this.whole ? new Map() : this.model.troublesAt(time);
    const marks = this.model.marksAt(time);
    return Object.entries(this.model.about.labels).map(([name, point]) => {
      const [x, y] = this.at(...point);
      const trouble = troubles.get(name);
      const words = (marks.get(name) || []).map((text) => [text, "wayname"]);
      if (trouble) words.push([`✕ ${trouble}`, "wayname bad"]);
      return [
        svg("circle", { class: trouble ? "label bad" : "label", cx: x, cy: y, r: 7 * this.unit }),
        this.text(this.model.title(name), point, 22, "labelname"),
        words.map(([text, kind], number) => this.text(text, point, -12 - 16 * number, kind)),
        this.boxes(lying.get(name) || [], x, y + 30 * this.unit),
      ];
    });
  }

  /** Boxes side by side, as wide as their names. */
  boxes(names, x, y) {
    const size = 16 * this.unit;
    const shown = names.map((name) => short(name, 12));
    const widths = shown.map((name) => Math.max(size, (0.46 * name.length + 0.5) * size));
    const gap = size * 0.15;
    let left = x - (widths.reduce((sum, width) => sum + width, 0) + gap * (names.length - 1)) / 2;
    return shown.map((name, number) => {
      const at = left;
      left += widths[number] + gap;
      return svg(
        "g",
        { class: "package", transform: `translate(${at} ${y})` },
        svg("rect", { width: widths[number], height: size, rx: size / 6 }),
        svg("text", { x: widths[number] / 2, y: size * 0.75, "font-size": size * 0.7 }, name),
        svg("title", {}, names[number])
      );
    });
  }

  robotShape(time, { name, pose: [east, north, yaw], colour }) {
    const [x, y] = this.at(east, north);
    const size = Math.max(9 * this.unit, 0.18 * this.scale);
    const carried = this.model.thingsAt(time).get(name) || [];
    return [
      name ? this.text(name, [east, north], -size / this.unit - 5, `robotname ${colour}`) : null,
      svg(
        "g",
        { class: `robot ${colour}`, transform: `translate(${x} ${y}) rotate(${(-yaw * 180) / Math.PI})` },
        svg("circle", { r: size }),
        svg("path", { d: `M ${0.9 * size} 0 L ${-0.4 * size} ${0.55 * size} L ${-0.1 * size} 0 L ${-0.4 * size} ${-0.55 * size} Z` }),
        name ? svg("title", {}, name) : null
      ),
      this.boxes(carried, x, y - size - (name ? 35 : 18) * this.unit),
    ];
  }

  /** Several robots, each with its place, its load, and what it does now and next. */
  list(time, robots) {
    const several = robots.filter(({ name }) => name);
    const lines = several.map((robot) => [robot, `${this.place(...robot.pose)}${this.load(time, robot.name)}`, this.deeds(time, robot.name)]);
    redraw(this.robots, lines, () => lines.map(([{ name, colour }, place, deeds]) => html("li", {}, html("strong", { class: `robotname ${colour}` }, name), ` ${place}`, deeds ? `; ${deeds}` : "")));
  }

  place(x, y) {
    const label = this.model.labelAt(x, y);
    return label ? `at ${this.model.title(label)}` : "on its way";
  }

  load(time, robot) {
    const load = this.model.thingsAt(time).get(robot);
    return load ? `, carries ${load.join(", ")}` : "";
  }

  /** What a robot does now and next. */
  deeds(time, robot) {
    if (this.whole) return "";
    const { now, ahead } = this.model.dutiesAt(time, robot);
    const parts = [now.map(({ deed }) => deed).join(", "), ahead.length ? `then ${ahead.slice(0, NUMBERED).map(({ deed }) => deed).join(", ")}` : ""];
    return parts.filter(Boolean).join(", ");
  }

  words(time, robots) {
    const names = robots.map(({ name }) => name);
    const lying = this.model.thingsAt(time);
    const carried = lying.get("");
    for (const name of ["", ...names]) lying.delete(name);
    const parts = names[0] ? [] : [this.only(time)];
    if (carried) parts.push(`It carries ${carried.join(", ")}.`);
    if (lying.size) {
      const places = [...lying].sort().map(([where, things]) => `${things.join(", ")} at ${this.model.title(where)}`);
      parts.push(`Things: ${places.join("; ")}.`);
    }
    for (const { kind, labels: [from, to], text } of this.model.waysAt(time)) {
      const said = text || (kind === "way" ? "" : kind);
      if (said) parts.push(`${this.model.title(from)} – ${this.model.title(to)}: ${said}.`);
    }
    for (const [label, marks] of this.model.marksAt(time)) parts.push(`${this.model.title(label)}: ${marks.join(", ")}.`);
    if (!this.whole) for (const [label, value] of this.model.troublesAt(time)) parts.push(`Not reached: ${this.model.title(label)} (${value}).`);
    return parts.join(" ");
  }

  /** Where the only robot is; of the whole run, its way. */
  only(time) {
    const pose = this.model.poseAt(time);
    const believed = this.model.believedPlaceAt(time);
    const unseen = believed ? `According to the program, the robot is at ${this.model.title(believed)}.` : "The robot's place was not recorded.";
    if (!pose) return unseen;
    const label = this.model.placeAt(time);
    const here = label ? `The robot is at ${this.model.title(label)}.` : "The robot is on its way.";
    return this.whole ? `The whole way: ${pose.metres.toFixed(1)} m. ${here}` : here;
  }
}

/** The point of a line at a part of its length. */
function along(points, part) {
  const lengths = points.slice(1).map(([x, y], number) => Math.hypot(x - points[number][0], y - points[number][1]));
  let left = part * lengths.reduce((sum, length) => sum + length, 0);
  for (let number = 0; number < lengths.length; number += 1) {
    if (left <= lengths[number]) {
      const share = lengths[number] ? left / lengths[number] : 0;
      return [0, 1].map((axis) => points[number][axis] + share * (points[number + 1][axis] - points[number][axis]));
    }
    left -= lengths[number];
  }
  return points[points.length - 1];
}
