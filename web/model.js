"use strict";
// The model of a run: its state at any moment, for the views. Its input is the JSON of runs/run_view.py, complete in a
// report, incremental on the live page. Times are seconds since the beginning of the run.

const TABLES = ["goals", "cycles", "words", "actions", "packages", "terms", "beliefs", "shapes", "poses", "paths", "scans", "log"];
const NEWS = new Set(["request", "cancel", "return", "fact"]); // kinds of lines of the log after which a plan is made

/** The states of goals that have not ended, and of those that have failed; the others are succeeded and canceled. */
const OPEN = new Set(["pending", "active", "canceling", "waiting"]);
const FAILED = new Set(["rejected", "aborted", "lost"]);

/** The index of the last record not later than a moment, in a list ordered by time; -1 if there is none. */
function lastAt(list, time, timeOf = (one) => one.time) {
  let low = 0;
  let high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeOf(list[middle]) <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** The last record not later than a moment; undefined if there is none. */
function latest(list, time) {
  return list[lastAt(list, time)];
}

/** The middle of some values. */
function median(values) {
  const sorted = [...values].sort((one, other) => one - other);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** Pairs of a key and a value as a Map of each key to its values. */
function grouped(pairs) {
  const found = new Map();
  for (const [key, value] of pairs) {
    if (!found.has(key)) found.set(key, []);
    found.get(key).push(value);
  }
  return found;
}

/** The text by which the records of an action are found. */
function wordOf(action) {
  return `${action.interface}(${action.parameter},${action.cycle})`;
}

class RunModel {
  constructor() {
    this.clear();
  }

  /** Forget all data, before another run or a complete new message. */
  clear() {
    this.about = { labels: {}, titles: {}, map: null, run: 1, pace: null, statuses: {} };
    this.seconds = 0;
    this.revision = 0;
    this.pace = null; // seconds of a live run's clock in a second, null if unknown
    this.paces = [];
    for (const name of TABLES) this[name] = [];
    this.tracks = new Map(); // the poses by robot, "" for an only robot: {time, pose ([x, y, yaw]), metres (driven)}
    this.robotNames = []; // of several robots: those with places, else those of the actions
    this.news = []; // the lines of the log about requests, returns and facts
  }

  /** Merge changes, at a moment of the browser's clock (ms) on a live page. */
  merge(changes, now = null) {
    if (changes.about) this.about = changes.about;
    if (now !== null) this.measure(now, changes.seconds);
    this.seconds = changes.seconds;
    this.revision = changes.revision;
    for (const name of TABLES) for (const [number, record] of changes[name]) this[name][number] = record;
    if (changes.log.length) this.news = this.log.filter(({ kind }) => NEWS.has(kind));
    if (changes.poses.length) this.tracks = grouped(this.poses.map((one) => [one.robot, one]));
    const drawn = this.shapes.filter(({ kind }) => kind === "robot").map(({ text }) => text);
    const placed = [...this.tracks.keys(), ...drawn].filter(Boolean);
    this.robotNames = [...new Set(placed.length ? placed : this.words.flatMap(({ robots }) => robots))].sort();
  }

  /** How fast the run's clock goes, empty if it keeps to real time. */
  paceWords() {
    const pace = this.pace === null ? this.about.pace : this.pace;
    return pace === null || Math.abs(pace - 1) < 0.15 ? "" : `${pace.toFixed(1)} × real time`;
  }

  /** Measure the pace of the run's clock over some seconds. */
  measure(now, at) {
    this.paces = [...this.paces.filter(([then]) => now - then <= 20000), [now, at]];
    const [then, before] = this.paces[0];
    if (now - then >= 5000) this.pace = (at - before) / ((now - then) / 1000);
  }

  /** The status of a goal for people. */
  said(word) {
    return this.about.statuses[word] || word;
  }

  /** The name of a label for people. */
  title(label) {
    return this.about.titles[label] || label;
  }

  /** The number of a robot, for its colour. */
  colour(robot) {
    return `r${Math.max(0, this.robotNames.indexOf(robot)) % 8}`;
  }

  /** The last record of the only robot's pose, null if unknown. */
  poseAt(time) {
    const poses = this.tracks.get("") || [];
    return latest(poses, time) || poses[0] || null;
  }

  /** The places of a robot up to a moment. */
  trackOf(name, time) {
    const poses = this.tracks.get(name) || [];
    return poses.slice(0, lastAt(poses, time) + 1).map(({ pose }) => pose);
  }

  /** The robot's label, "" away from all labels. */
  placeAt(time) {
    const found = this.poseAt(time);
    return found ? this.labelAt(...found.pose) : "";
  }

  /** The label at a point, "" away from all labels. */
  labelAt(atX, atY) {
    const near = Object.entries(this.about.labels)
      .map(([name, [x, y]]) => [Math.hypot(x - atX, y - atY), name])
      .sort((one, other) => one[0] - other[0])[0];
    return near && near[0] <= 0.5 ? near[1] : "";
  }

  cycleAt(time) {
    return lastAt(this.cycles, time);
  }

  /** The current plan: {cycle, plan, number (of the cycle's plans), actions}; null before the first. */
  planAt(time) {
    for (let number = this.cycleAt(time); number >= 0; number -= 1) {
      const cycle = this.cycles[number];
      const last = lastAt(cycle.plans, time);
      if (last >= 0) {
        const plan = cycle.plans[last];
        return { cycle, plan, number: last, actions: plan.actions.map((word) => this.words[word]) };
      }
    }
    return null;
  }

  /** The plan's actions that have not begun. */
  aheadAt(time) {
    const found = this.planAt(time);
    if (!found) return [];
    const begun = this.begunAt(time, found.cycle.cycle);
    return found.actions.filter((action) => !begun.get(wordOf(action)) && action.cycle >= found.cycle.cycle);
  }

  /** The actions that have begun, by word; a running action also has the word of the present cycle, in which it goes on. */
  begunAt(time, cycle) {
    const all = this.actionsAt(time);
    const running = this.runningAt(time).map((one) => [wordOf({ ...one.word, cycle }), one]);
    return new Map([...running, ...all.map((one) => [wordOf(one.word), one])]);
  }

  /** The actions that have begun, each with its state: "now", "done", "failed", or "gone" for a cancelled action. */
  actionsAt(time) {
    const begun = this.actions.slice(0, lastAt(this.actions, time, (one) => one.begun) + 1);
    return begun.map((one) => {
      const under = one.ended === null || one.ended > time;
      return { ...one, word: this.words[one.action], state: under ? "now" : one.failed ? "failed" : one.preempted ? "gone" : "done" };
    });
  }

  /** The actions that run. */
  runningAt(time) {
    return this.actionsAt(time).filter((one) => one.state === "now");
  }

  /** The actions that run, then those of the plan that have not begun; of one robot if its name is given. */
  dutiesAt(time, robot = "") {
    const mine = (action) => !robot || action.robots.includes(robot);
    const now = this.runningAt(time).map((one) => one.word);
    return { now: now.filter(mine), ahead: this.aheadAt(time).filter(mine) };
  }

  /** The next places of a robot's actions, each with its action, without places next to the one before. */
  movesAt(time, robot, [x, y]) {
    const { now, ahead } = this.dutiesAt(time, robot);
    const moves = [];
    let last = [x, y];
    for (const action of [...now, ...ahead]) {
      const label = this.about.labels[action.parameter];
      if (!label || Math.hypot(label[0] - last[0], label[1] - last[1]) < 0.1) continue;
      moves.push({ action, from: last, to: label.slice(0, 2) });
      last = label;
    }
    return moves;
  }

  /** How long actions took until a moment: a function from an action to the median of the same ones, of its kind, or of all. */
  usualAt(time) {
    const done = this.actionsAt(time).filter((one) => one.state === "done");
    const keys = ({ words, kind }) => [`=${words}`, kind, ""];
    const lengths = grouped(done.flatMap((one) => keys(one.word).map((key) => [key, one.ended - one.begun])));
    return (action) => median(lengths.get(`=${action.words}`) || lengths.get(action.kind) || lengths.get("") || [5]);
  }

  /** The moment of the latest request, return or fact up to a moment; null before the first. */
  newsAt(time) {
    const news = latest(this.news, time);
    return news ? news.time : null;
  }

  /** The searches for plans up to a moment: {begun, ended, wall (seconds of the solver)}; each begins with the latest news. */
  searchesAt(time) {
    const plans = this.cycles.flatMap((cycle) => cycle.plans).filter((plan) => plan.time <= time);
    return plans.map((plan) => {
      const news = this.newsAt(plan.time);
      return { begun: news === null ? plan.time : news, ended: plan.time, wall: (plan.ground || 0) + (plan.solve || 0) };
    });
  }

  /** Since when the robot waits for a plan, null if it does not: no plan followed the latest news, and no action runs. */
  thinkingAt(time) {
    const found = this.planAt(time);
    const news = this.newsAt(time);
    if (news === null || time - news < 1 || (found && found.plan.time >= news) || this.runningAt(time).length) return null;
    return this.openGoalsAt(time).length ? news : null;
  }

  /** The states of the goals that have not ended, as `goalAt` has them. */
  openGoalsAt(time) {
    return this.goals.map((goal) => this.goalAt(goal, time)).filter((state) => state && state.open);
  }

  /** The state of a goal: {word, reason, details, waited (s), open, failed, explained (the reason matters)}; null before it was sent. */
  goalAt(goal, time) {
    const number = lastAt(goal.states, time, (one) => one[0]);
    if (goal.sent > time || number < 0) return null;
    const [, word, reason, details] = goal.states[number];
    const end = goal.ended !== null && goal.ended <= time ? goal.ended : time;
    const failed = FAILED.has(word);
    return { word, reason, details, waited: end - goal.sent, open: OPEN.has(word), failed, explained: failed || word === "waiting" };
  }

  /** Seconds until a goal was accepted, null if it was not. */
  response(goal) {
    const found = goal.states.find((one) => one[1] === "active");
    return found ? found[0] - goal.sent : null;
  }

  /** The places of things: pairs of a name and a label, or of a robot's name ("" for the only robot); from the topic, else from the beliefs. */
  packagesAt(time) {
    const published = latest(this.packages, time);
    if (published) return published.places;
    const drawn = this.drawnAt(time).filter(({ kind }) => kind === "thing" || kind === "carried");
    return drawn.map(({ labels, text }) => {
      const [robot, ...thing] = text.split(" ");
      return !labels.length && thing.length && this.robotNames.includes(robot) ? [thing.join(" "), robot] : [text, labels[0] || ""];
    });
  }

  /** The names of the things at a place, by place: a label, or a robot's name ("" for the only robot). */
  thingsAt(time) {
    return grouped(this.packagesAt(time).map(([name, place]) => [place, name]));
  }

  /** The robots that have a pose: {name ("" for the only one), pose ([x, y, yaw]), colour}; without a recorded pose, it is that of a label. */
  robotsAt(time) {
    const found = new Map();
    for (const { kind, labels, text } of this.drawnAt(time)) {
      if (kind === "robot" && text) found.set(text, { name: text, pose: this.about.labels[labels[0]] });
    }
    for (const [name, poses] of this.tracks) {
      const last = latest(poses, time);
      if (name && last) found.set(name, { name, pose: last.pose });
    }
    const several = [...found.values()].filter(({ pose }) => pose).sort((one, other) => (one.name < other.name ? -1 : 1));
    if (several.length) return several.map((robot) => ({ ...robot, colour: this.colour(robot.name) }));
    const { pose } = this.poseAt(time) || { pose: this.about.labels[this.believedPlaceAt(time)] };
    return pose ? [{ name: "", pose, colour: "" }] : [];
  }

  /** The program's drawings: {kind, labels, text}. */
  drawnAt(time) {
    const { shapes } = latest(this.beliefs, time) || { shapes: [] };
    return shapes.map((shape) => this.shapes[shape]).filter(({ labels }) => labels.every((name) => name in this.about.labels));
  }

  beliefsAt(time) {
    const { atoms } = latest(this.beliefs, time) || { atoms: [] };
    return atoms.map((term) => this.terms[term].text);
  }

  pathAt(time) {
    return (latest(this.paths, time) || { points: [] }).points;
  }

  /** Ways between two labels: {kind ("way", "open" or "blocked"), labels, text}, the most important last. */
  waysAt(time) {
    const kinds = ["way", "open", "blocked"];
    const ways = this.drawnAt(time).filter(({ kind }) => kinds.includes(kind));
    return ways.sort((one, other) => kinds.indexOf(one.kind) - kinds.indexOf(other.kind));
  }

  /** Texts at labels: Map of label to a list of texts. */
  marksAt(time) {
    return grouped(this.drawnAt(time).filter(({ kind }) => kind === "mark").map(({ labels, text }) => [labels[0], text]));
  }

  /** The robot's label by the program's beliefs, "" if unknown. */
  believedPlaceAt(time) {
    const robot = this.drawnAt(time).find(({ kind, text }) => kind === "robot" && !text);
    return robot ? robot.labels[0] : "";
  }

  /** Labels that the latest action failed to reach: Map of label to reason. */
  troublesAt(time) {
    const troubles = new Map();
    for (const one of this.actionsAt(time)) {
      if (one.state === "now" || one.state === "gone" || !(one.word.parameter in this.about.labels)) continue;
      if (one.failed) troubles.set(one.word.parameter, one.value);
      else troubles.delete(one.word.parameter);
    }
    return troubles;
  }

  /** Whether the solver's times are known. */
  get timed() {
    return this.cycles.some((cycle) => cycle.plans.some((plan) => plan.ground !== null));
  }

  /** The solver's seconds: {ground, solve}. */
  solverTime(cycle) {
    const sum = (name) => cycle.plans.reduce((total, plan) => total + plan[name], 0);
    return { ground: sum("ground"), solve: sum("solve") };
  }
}
