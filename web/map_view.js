"use strict";
// The map with robot, ways, labels and things, in a drawing 1000 pixels wide.

const HIGHEST = 640; // pixels, as page.css has it

class MapView {
  constructor(parent, model) {
    this.model = model;
    this.caption = html("p", { class: "caption" });
    this.picture = svg("svg", { class: "map", role: "img", "aria-label": "Map; its contents are listed below" });
    show(parent, this.picture, this.caption);
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
      for (const pose of this.model.poses) points.push([pose[1], pose[2]]);
      for (const { pose } of this.model.robots) points.push([pose[0], pose[1]]);
    }
    if (!points.length) return null;
    const margin = map ? 0 : 1;
    const xs = points.map((point) => point[0]);
    const ys = points.map((point) => point[1]);
    const least = (values) => values.reduce((one, other) => Math.min(one, other)) - margin;
    const most = (values) => values.reduce((one, other) => Math.max(one, other)) + margin;
    return { x0: least(xs), y0: least(ys), x1: most(xs), y1: most(ys) };
  }

  draw(time) {
    const bounds = this.bounds();
    this.caption.textContent = this.words(time);
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
    show(this.picture, this.floor(), this.ways(time), this.driven(time), this.ahead(time), this.labels(time), this.robot(time));
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

  driven(time) {
    return this.line(this.model.track(time).map((pose) => [pose[1], pose[2]]), "driven");
  }

  /** The robot's path to the next place, and straight lines to later places. */
  ahead(time) {
    const robots = this.model.robotsAt(time);
    if (robots.length) return robots.map(({ name, pose }) => this.aheadOf(time, name, pose));
    const labels = this.model.about.labels;
    const pose = this.model.poseAt(time);
    const under = this.model.actionsAt(time).filter((one) => one.state === "now").map((one) => one.word);
    const places = [...under, ...this.model.aheadAt(time)].map((action) => action.parameter).filter((name) => name in labels);
    const points = [...(pose ? [[pose[1], pose[2]]] : []), ...places.map((name) => labels[name])];
    const moving = under.some((action) => action.parameter in labels);
    return [moving ? this.line(this.model.pathAt(time), "path") : null, points.length > 1 ? this.line(points, "ahead") : null];
  }

  /** Straight lines to the next places of one of several robots: those of its actions, such as move_base(r1). */
  aheadOf(time, name, pose) {
    const labels = this.model.about.labels;
    const under = this.model.actionsAt(time).filter((one) => one.state === "now").map((one) => one.word);
    const own = [...under, ...this.model.aheadAt(time)].filter((action) => action.interface.split(/[(,)]/).slice(1).includes(name));
    const places = own.map((action) => action.parameter).filter((place) => place in labels);
    return places.length ? this.line([[pose[0], pose[1]], ...places.map((place) => labels[place])], "ahead") : null;
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

  text(words, [x, y], down, name) {
    const [left, top] = this.at(x, y);
    const size = 13 * this.unit;
    return svg("text", { class: name, x: left, y: top + down * this.unit, "font-size": size, "stroke-width": size / 5 }, words);
  }

  labels(time) {
    const lying = new Map();
    for (const [name, place] of this.model.packagesAt(time)) lying.set(place, [...(lying.get(place) || []), name]);
    const troubles = this.model.troublesAt(time);
    const marks = this.model.marksAt(time);
    return Object.entries(this.model.about.labels).map(([name, point]) => {
      const [x, y] = this.at(...point);
      const trouble = troubles.get(name);
      const words = (marks.get(name) || []).map((text) => [short(text, 30), "wayname"]);
      if (trouble) words.push([`✕ ${short(trouble, 20)}`, "wayname bad"]);
      return [
        svg("circle", { class: trouble ? "label bad" : "label", cx: x, cy: y, r: 7 * this.unit }),
        this.text(name, point, 22, "labelname"),
        words.map(([text, kind], number) => this.text(text, point, -12 - 16 * number, kind)),
        this.boxes(lying.get(name) || [], x, y + 30 * this.unit),
      ];
    });
  }

  /** Boxes side by side, as wide as their names. */
  boxes(names, x, y) {
    const size = 16 * this.unit;
    const shown = names.map((name) => short(name, 12));
    const widths = shown.map((name) => Math.max(size, (0.42 * name.length + 0.4) * size));
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

  robot(time) {
    const robots = this.model.robotsAt(time);
    if (robots.length) return robots.map(({ name, pose }) => this.robotShape(time, [time, ...pose], name));
    const believed = this.model.about.labels[this.model.believedPlaceAt(time)];
    const pose = this.model.poseAt(time) || (believed && [time, ...believed]);
    return pose ? this.robotShape(time, pose, "") : null;
  }

  robotShape(time, pose, name) {
    const [x, y] = this.at(pose[1], pose[2]);
    const size = Math.max(9 * this.unit, 0.18 * this.scale);
    const carried = this.model.packagesAt(time).filter(([, place]) => place === name).map(([thing]) => thing);
    return [
      name ? this.text(name, [pose[1], pose[2]], size / this.unit + 14, "labelname") : null,
      svg(
        "g",
        { class: "robot", transform: `translate(${x} ${y}) rotate(${(-pose[3] * 180) / Math.PI})` },
        svg("circle", { r: size }),
        svg("path", { d: `M ${0.9 * size} 0 L ${-0.4 * size} ${0.55 * size} L ${-0.1 * size} 0 L ${-0.4 * size} ${-0.55 * size} Z` })
      ),
      this.boxes(carried, x, y - size - 18 * this.unit),
    ];
  }

  words(time) {
    const pose = this.model.poseAt(time);
    const place = this.model.placeAt(time);
    const lying = new Map();
    for (const [name, where] of this.model.packagesAt(time)) lying.set(where, [...(lying.get(where) || []), name]);
    const carried = lying.get("");
    lying.delete("");
    const robots = this.model.robotsAt(time);
    const loads = robots.map(({ name }) => lying.get(name));
    for (const { name } of robots) lying.delete(name);
    const believed = this.model.believedPlaceAt(time);
    const unseen = believed ? `According to the program, the robot is at ${believed}.` : "The robot's place was not recorded.";
    const robot = !pose ? unseen : place ? `The robot is at ${place}.` : "The robot is on its way.";
    const parts = robots.length ? [] : [robot];
    robots.forEach(({ name, pose: [x, y] }, number) => {
      const label = this.model.labelAt(x, y);
      const load = loads[number] ? `, carries ${loads[number].join(", ")}` : "";
      parts.push(`${name} is ${label ? `at ${label}` : "on its way"}${load}.`);
    });
    if (carried) parts.push(`It carries ${carried.join(", ")}.`);
    if (lying.size) {
      const places = [...lying].sort().map(([where, names]) => `${names.join(", ")} at ${where}`);
      parts.push(`Things: ${places.join("; ")}.`);
    }
    for (const { kind, labels: [from, to], text } of this.model.waysAt(time)) {
      const said = text || (kind === "way" ? "" : kind);
      if (said) parts.push(`${from} – ${to}: ${said}.`);
    }
    for (const [label, words] of this.model.marksAt(time)) parts.push(`${label}: ${words.join(", ")}.`);
    for (const [label, value] of this.model.troublesAt(time)) parts.push(`Not reached: ${label} (${value}).`);
    return parts.join(" ");
  }
}
