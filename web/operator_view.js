"use strict";
// What an operator needs first: the robot's present action, its health, pause and stop, messages and explanations.

const LEVELS = ["ok", "warn", "error", "stale"];
const LIGHTS = ["All is well", "Warning", "Error", "No reports"];

/** Seconds for which a message is shown, unless it is about a failure. */
const MESSAGE_TIME = 12;

/** Messages at the edge of the page, and explanations and questions in a dialog. */
class Notices {
  constructor(messages, dialog) {
    this.messages = messages;
    this.dialog = dialog;
    this.title = html("h2", { id: "dialog-title" });
    this.content = html("div");
    this.buttons = html("div", { class: "row" });
    dialog.setAttribute("aria-labelledby", this.title.id);
    show(dialog, this.title, this.content, this.buttons);
  }

  /** Show a message in place of the last one about the same thing; one about a failure stays until it is closed. */
  say(text, bad = false, about = "") {
    const box = html("div", { class: bad ? "message bad" : "message", "data-about": about }, html("span", {}, text));
    for (const other of [...this.messages.children]) if (about && other.dataset.about === about) other.remove();
    box.append(button("×", () => box.remove(), { "aria-label": "Close the message" }));
    this.messages.append(box);
    while (this.messages.children.length > 3) this.messages.firstElementChild.remove();
    if (!bad) window.setTimeout(() => box.remove(), 1000 * MESSAGE_TIME);
  }

  /** Show an explanation, its terms folded. */
  explain(title, lines, terms = "") {
    const rules = terms && folded("Rules and facts", terms, new Set(), "");
    this.open(`Why? ${title}`, [html("ul", {}, lines.map((line) => html("li", {}, line))), rules], [["Close", () => undefined]]);
  }

  /** Ask for a confirmation before ``act``. */
  confirm(title, text, name, act) {
    this.open(title, [html("p", {}, text)], [[name, act], ["Back", () => undefined]]);
  }

  open(title, content, buttons) {
    this.title.textContent = title;
    show(this.content, content);
    const close = (act) => () => {
      this.dialog.close();
      act();
    };
    show(this.buttons, buttons.map(([name, act]) => button(name, close(act), { class: name })));
    if (!this.dialog.open) this.dialog.showModal();
    this.buttons.lastElementChild.focus();
  }
}

class OperatorView {
  /** ``ask`` sends a message and calls a function with its answer. */
  constructor(model, ask, notices) {
    this.model = model;
    this.notices = notices;
    this.part = (name) => document.getElementById(name);
    const command = (message) => () => ask(message, ({ fault, done }) => notices.say(fault ? `Not done: ${fault}` : done, Boolean(fault)));
    this.part("pause").addEventListener("click", () => {
      if (this.mode !== "running") command({ pause: false })();
      else notices.confirm("Pause the robot?", "What it does now ends as usual. Nothing else begins until you continue.", "Pause", command({ pause: true }));
    });
    const words = "What it does now is cancelled, and all goals are given up. It rests until the next order.";
    this.part("stop").addEventListener("click", () => notices.confirm("Stop the robot?", words, "Stop", command({ stop: true })));
  }

  /** Show the state of core and robot; ``operates``: this page can pause and stop them. */
  draw({ core, mode, health, operates }) {
    this.mode = mode;
    this.part("commands").hidden = !operates;
    say(this.part("pause"), mode === "running" ? "Pause" : "Continue");
    const now = this.part("now");
    say(now, this.now(core));
    now.className = `now ${core ? mode : "stopped"}`;
    this.light(health);
  }

  /** The present actions, or why there are none. */
  now(core) {
    if (!core) return "The core is not running";
    const doing = this.model.dutiesAt(this.model.seconds).now;
    const said = doing.map(({ words }) => words).join(", ");
    if (this.mode === "paused") return said ? `Paused after this: ${said}` : "Paused";
    if (said) return doing[0].robots.some((robot) => said.startsWith(robot)) ? said : capital(said);
    if (this.mode === "stopped") return "Stopped until the next order";
    const since = this.model.thinkingAt(this.model.seconds);
    if (since !== null) return `Searching for a plan for ${seconds(Math.floor(this.model.seconds - since))}`;
    const open = this.model.openGoalsAt(this.model.seconds);
    const reason = open.map((state) => state.reason).find(Boolean);
    return open.length ? `Waits${reason ? `: ${reason}` : " or plans"}` : "Idle: no open goals";
  }

  /** One light for all reports on /diagnostics: [name, level, message]. */
  light(health) {
    const box = this.part("health");
    const worst = Math.max(0, ...health.map(([, level]) => level));
    box.hidden = !health.length;
    box.className = `health ${LEVELS[worst]}`;
    say(this.part("light"), LIGHTS[worst]);
    redraw(this.part("reports"), health, () => health.map(([name, level, message]) => html("li", { class: LEVELS[level] }, html("strong", {}, name), ` ${LEVELS[level]}: ${message}`)));
  }
}
