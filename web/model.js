"use strict";
// A run as the views ask for it: what was known and done at a moment. It is fed with the JSON of runs/run_view.py, all
// at once in a report, bit by bit on the live page. Times are seconds since the run began.

const TABLES = ["goals", "cycles", "actions", "packages", "beliefs", "drawn", "paths", "log"];
const OPEN = new Set(["pending", "active", "canceling", "waiting"]);

/** The number of the last record of a list, ordered by a time, that is not later than a moment; -1 where none is. */
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

class RunModel {
  constructor() {
    this.clear();
  }

  /** Forget all: another run begins, or the same is told anew. */
  clear() {
    this.born = (this.born || 0) + 1;
    this.about = { labels: {}, map: null, run: 1 };
    this.seconds = 0;
    this.revision = 0;
    this.thinned = 0;
    this.terms = [];
    this.words = [];
    this.shapes = [];
    this.poses = [];
    for (const name of TABLES) this[name] = [];
  }

  /** Take what is new. */
  merge(changes) {
    if (changes.about) this.about = changes.about;
    this.seconds = changes.seconds;
    this.revision = changes.revision;
    this.thinned = changes.thinned;
    for (const term of changes.terms) this.terms.push(term);
    for (const word of changes.words) this.words.push(word);
    for (const shape of changes.shapes) this.shapes.push(shape);
    this.poses.length = changes.first;
    for (const pose of changes.poses) this.poses.push(pose);
    for (const name of TABLES) for (const [number, record] of changes[name]) this[name][number] = record;
  }

  actionName(action) {
    return action.parameter === "" ? action.interface : `${action.interface} ${action.parameter}`;
  }

  /** Where the robot is: [time, x, y, yaw, metres driven], null where that is not known. */
  poseAt(time) {
    const number = lastAt(this.poses, time, (pose) => pose[0]);
    return number < 0 ? this.poses[0] || null : this.poses[number];
  }

  track(time) {
    return this.poses.slice(0, lastAt(this.poses, time, (pose) => pose[0]) + 1);
  }

  /** The label that the robot is at, "" away from all. */
  placeAt(time) {
    const pose = this.poseAt(time);
    if (!pose) return "";
    const near = Object.entries(this.about.labels)
      .map(([name, [x, y]]) => [Math.hypot(x - pose[1], y - pose[2]), name])
      .sort((one, other) => one[0] - other[0])[0];
    return near && near[0] <= 0.5 ? near[1] : "";
  }

  cycleAt(time) {
    return lastAt(this.cycles, time);
  }

  /** The plan in force: {cycle, plan, number (of the cycle's plans), actions}; null before the first. */
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

  /** What the plan still has to do: actions from its cycle on that have not begun. */
  aheadAt(time) {
    const found = this.planAt(time);
    if (!found) return [];
    const begun = new Set(this.actions.slice(0, lastAt(this.actions, time, (one) => one.begun) + 1).map((one) => one.action));
    const words = found.plan.actions.filter((word) => !begun.has(word));
    return words.map((word) => this.words[word]).filter((action) => action.cycle >= found.cycle.cycle);
  }

  /** The actions that have begun, each with its state: "now", "done", "failed", or "gone" if the core has cancelled it. */
  actionsAt(time) {
    const begun = this.actions.slice(0, lastAt(this.actions, time, (one) => one.begun) + 1);
    return begun
      .map((one) => {
        const under = one.ended === null || one.ended > time;
        return { ...one, word: this.words[one.action], state: under ? "now" : one.failed ? "failed" : one.preempted ? "gone" : "done" };
      });
  }

  /** How a goal stands: {word, reason, waited}; null where it has not been sent yet. */
  goalAt(goal, time) {
    const number = lastAt(goal.states, time, (one) => one[0]);
    if (goal.sent > time || number < 0) return null;
    const [, word, reason] = goal.states[number];
    const end = goal.ended !== null && goal.ended <= time ? goal.ended : time;
    return { word, reason, waited: end - goal.sent, open: OPEN.has(word) };
  }

  /** Seconds until a goal was accepted, null where it was not. */
  response(goal) {
    const found = goal.states.find((one) => one[1] === "active");
    return found ? found[0] - goal.sent : null;
  }

  /** Where things are: pairs of a name and a label, "" for the robot. What was told counts, else what is believed. */
  packagesAt(time) {
    const number = lastAt(this.packages, time);
    if (number >= 0) return this.packages[number].places;
    const drawn = this.drawnAt(time).filter(({ kind }) => kind === "thing" || kind === "carried");
    return drawn.map(({ labels, text }) => [text, labels[0] || ""]);
  }

  /** What the program wants to have drawn: {kind, labels, text}. */
  drawnAt(time) {
    const number = lastAt(this.drawn, time);
    return number < 0 ? [] : this.drawn[number].shapes.map((shape) => this.shapes[shape]).filter(({ labels }) => labels.every((name) => name in this.about.labels));
  }

  beliefsAt(time) {
    const number = lastAt(this.beliefs, time);
    return number < 0 ? [] : this.beliefs[number].atoms.map((term) => this.terms[term]);
  }

  pathAt(time) {
    const number = lastAt(this.paths, time);
    return number < 0 ? [] : this.paths[number].points;
  }

  /** Ways between two labels: {kind ("way", "open" or "blocked"), labels, text}, those that matter most last. */
  waysAt(time) {
    const kinds = ["way", "open", "blocked"];
    const ways = this.drawnAt(time).filter(({ kind }) => kinds.includes(kind));
    return ways.sort((one, other) => kinds.indexOf(one.kind) - kinds.indexOf(other.kind));
  }

  /** Words at labels: Map of label to a list of them. */
  marksAt(time) {
    const marks = new Map();
    for (const { kind, labels, text } of this.drawnAt(time)) {
      if (kind === "mark") marks.set(labels[0], [...(marks.get(labels[0]) || []), text]);
    }
    return marks;
  }

  /** The label where the robot is as far as the program knows, "" where it does not say. */
  believedPlaceAt(time) {
    const robot = this.drawnAt(time).find(({ kind }) => kind === "robot");
    return robot ? robot.labels[0] : "";
  }

  /** Labels that an action has not led to, and why, until one does: Map of label to value. */
  troublesAt(time) {
    const troubles = new Map();
    for (const one of this.actionsAt(time)) {
      if (one.state === "now" || one.state === "gone" || !(one.word.parameter in this.about.labels)) continue;
      if (one.failed) troubles.set(one.word.parameter, one.value);
      else troubles.delete(one.word.parameter);
    }
    return troubles;
  }

  /** Whether it is known how long the solver took. */
  get timed() {
    return this.cycles.some((cycle) => cycle.plans.some((plan) => plan.ground !== null));
  }

  /** Seconds that the solver took: {ground, solve}. */
  solverTime(cycle) {
    const sum = (name) => cycle.plans.reduce((total, plan) => total + plan[name], 0);
    return { ground: sum("ground"), solve: sum("solve") };
  }
}
