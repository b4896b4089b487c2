"use strict";
// Figures of the whole run.

const FEWEST = 5; // values of a histogram; fewer are listed
const CHART = { width: 320, height: 150, left: 48, bottom: 22, top: 8 };

/** A run's figures: counts, sums and lists for charts and summary. */
function figures(model) {
  const ends = new Map();
  for (const goal of model.goals) {
    const word = goal.ended === null ? "open" : goal.states[goal.states.length - 1][1];
    ends.set(word, (ends.get(word) || 0) + 1);
  }
  const solver = model.cycles.map((cycle) => model.solverTime(cycle));
  const total = solver.reduce((sum, one) => sum + one.ground + one.solve, 0);
  const last = model.poseAt(Infinity);
  return {
    ends,
    ended: [...ends].map(([word, number]) => `${number} ${model.said(word)}`).join(", "),
    waits: model.goals.filter((goal) => goal.ended !== null).map((goal) => goal.ended - goal.sent),
    responses: model.goals.map((goal) => model.response(goal)).filter((value) => value !== null),
    metres: last ? last.metres : null,
    solver,
    total,
    longest: solver.reduce((most, one) => Math.max(most, one.ground + one.solve), 0),
  };
}

/** Some durations in words. */
function spread(values) {
  if (values.length < FEWEST) return values.map(seconds).join(", ") || "none";
  return `median ${seconds(median(values))}, longest ${seconds(Math.max(...values))}`;
}

class ChartsView {
  constructor(parent, model) {
    this.model = model;
    this.parent = parent;
  }

  draw() {
    redraw(this.parent, [this.model.goals.length, this.model.log.length, Math.round(this.model.seconds / 5)], () => this.all());
  }

  /** Short lists of values, and the charts of long ones. */
  all() {
    const found = figures(this.model);
    const solver = `${brief(found.total)} of wall time, ${brief(found.longest)} in the longest cycle`;
    const charts = [
      this.chart("Goals by their end", count(this.model.goals.length, "goal", "goals"), this.ends(found.ends), 6 + 26 * found.ends.size),
      this.chart("Time until the end", spread(found.waits), this.histogram(found.waits)),
      this.chart("Response: time until accepted", spread(found.responses), this.histogram(found.responses)),
    ];
    if (this.model.timed) charts.push(this.chart("Search for plans", solver, this.solver(found.solver)));
    if (found.metres !== null) charts.push(this.chart("Metres driven", `${found.metres.toFixed(1)} m`, this.metres(found.metres)));
    const listed = charts.filter(({ shapes }) => !shapes).map(({ title, words }) => [title, words]);
    const drawn = charts.filter(({ shapes }) => shapes).map((one) => this.figure(one));
    return [listed.length ? definitions(listed, { class: "listed" }) : null, html("div", { class: "charts" }, drawn)];
  }

  chart(title, words, shapes, height = CHART.height) {
    return { title, words, shapes, height };
  }

  figure({ title, words, shapes, height }) {
    const size = `0 0 ${CHART.width} ${height}`;
    const picture = svg("svg", { class: "chart", role: "img", "aria-label": `${title}: ${words}`, viewBox: size }, shapes);
    return html("figure", {}, html("figcaption", {}, html("strong", {}, title), html("span", {}, words)), picture);
  }

  ends(ends) {
    const most = Math.max(1, ...ends.values());
    return [...ends].map(([word, number], row) => {
      const [top, width] = [6 + row * 26, (number / most) * (CHART.width - 130)];
      return [
        svg("text", { class: "tick start", x: 0, y: top + 15 }, this.model.said(word)),
        svg("rect", { class: `end ${word}`, x: 94, y: top, width, height: 20, rx: 3 }),
        svg("text", { class: "tick start", x: 100 + width, y: top + 15 }, number),
      ];
    });
  }

  /** Both axes, and their scale functions; ticks are pairs of a value and words. */
  axes(most, to, rows, ticks) {
    const [right, low] = [CHART.width - 16, CHART.height - CHART.bottom];
    const x = (value) => CHART.left + (value / (to || 1)) * (right - CHART.left);
    const y = (value) => low - (value / (most || 1)) * (low - CHART.top);
    const shapes = [
      rows.map(([at, words]) => [
        svg("line", { class: "grid", x1: CHART.left, x2: right, y1: y(at), y2: y(at) }),
        svg("text", { class: "tick end", x: CHART.left - 5, y: y(at) + 4 }, words),
      ]),
      ticks.map(([at, words]) => svg("text", { class: "tick", x: x(at), y: CHART.height - 5 }, words)),
    ];
    return { x, y, low, shapes };
  }

  histogram(values) {
    if (values.length < FEWEST) return null;
    const most = Math.max(...values, 1);
    const bins = new Array(Math.min(12, Math.max(4, values.length))).fill(0);
    for (const value of values) bins[Math.min(bins.length - 1, Math.floor((value / most) * bins.length))] += 1;
    const highest = Math.max(...bins);
    const rows = marks(0, highest, 4).filter(Number.isInteger).map((at) => [at, at]);
    const { x, y, low, shapes } = this.axes(highest, most, rows, moments(0, most, 4));
    const width = (x(most) - x(0)) / bins.length;
    return [shapes, bins.map((number, at) => svg("rect", { class: "fill", x: x(0) + at * width + 1, y: y(number), width: width - 2, height: low - y(number) }))];
  }

  /** The solver's time in each cycle; with more cycles than pixels, the maximum of several cycles. */
  solver(cycles) {
    if (!cycles.length) return null;
    const group = Math.ceil(cycles.length / 90);
    const bars = [];
    for (let at = 0; at < cycles.length; at += group) {
      const sum = (one) => one.ground + one.solve;
      bars.push(cycles.slice(at, at + group).reduce((one, other) => (sum(other) > sum(one) ? other : one)));
    }
    const most = Math.max(...bars.map((one) => one.ground + one.solve), 0.001);
    const high = most * 1.35; // with room for words above the bars
    const rows = marks(0, high, 4).map((at) => [at, brief(at).replace(".0 s", " s")]);
    const { x, y, shapes } = this.axes(high, cycles.length, rows, marks(0, cycles.length, 4).map((at) => [at, at]));
    const width = (x(group) - x(0)) * 0.8;
    const bar = (name, at, from, to) =>
      svg("rect", { class: name, x: x(at * group), y: y(to), width, height: Math.max(0, y(from) - y(to)) });
    return [
      shapes,
      bars.map((one, at) => [bar("fill", at, 0, one.ground), bar("fill second", at, one.ground, one.ground + one.solve)]),
      svg("text", { class: "tick end", x: CHART.width - 6, y: 14 }, "of each cycle: grounding, "),
      svg("text", { class: "tick end second", x: CHART.width - 6, y: 28 }, "searching"),
    ];
  }

  metres(most) {
    const { x, y, shapes } = this.axes(most, this.model.seconds, marks(0, most || 1, 4).map((at) => [at, `${at} m`]), moments(0, this.model.seconds || 1, 4));
    const all = this.model.tracks.get("");
    const step = Math.max(1, Math.floor(all.length / 300));
    const poses = all.filter((_pose, number) => number % step === 0 || number === all.length - 1);
    const points = poses.map(({ time, metres }) => `${x(time).toFixed(1)},${y(metres).toFixed(1)}`);
    return [shapes, svg("polyline", { class: "curve", points: points.join(" ") })];
  }
}
