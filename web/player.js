"use strict";
// All views of a run at the moment of the slider. A report begins with the whole run; the live page follows the present,
// and has a slider only while one looks back.

class Player {
  constructor(model, live = false) {
    this.model = model;
    this.live = live;
    this.time = 0;
    this.home = true; // shows the whole run, or follows the present
    const seek = (time) => this.seek(time);
    const part = (name) => document.getElementById(name);
    this.goals = new GoalsView(part("goals"), model);
    this.map = new MapView(part("map"), model);
    this.views = [
      this.map,
      new TimelineView(part("timeline"), model, seek),
      this.goals,
      new PlanView(part("plan"), model),
      new LogView(part("log"), model, seek),
    ];
    this.charts = new ChartsView(part("charts"), model);
    this.slider = part("slider");
    this.clock = part("clock");
    this.playing = null;
    this.controls(part);
    this.update();
  }

  /** Update all views. */
  update() {
    this.title();
    this.slider.max = Math.max(this.model.seconds, 0.1);
    this.charts.draw();
    this.show();
  }

  title() {
    const { title, source, verdict, lacks } = this.model.about;
    document.title = title || "A run";
    say(document.getElementById("title"), title || "A run");
    const found = figures(this.model);
    const words = [
      `${count(this.model.goals.length, "goal", "goals")}${found.ended ? `: ${found.ended}` : ""}`,
      seconds(this.model.seconds),
      count(this.model.cycles.length, "cycle", "cycles"),
      found.metres === null ? null : `${found.metres.toFixed(1)} m driven`,
      this.model.timed ? `${brief(found.total)} of search for plans` : null,
      this.model.paceWords(),
      source,
      lacks ? `Not shown: ${lacks}.` : null,
    ];
    show(document.getElementById("facts"), words.filter(Boolean).map((one) => html("li", {}, one)));
    if (!verdict) return;
    const box = document.getElementById("verdict");
    box.hidden = false;
    box.className = verdict.length ? "bad" : "good";
    show(box, verdict.length ? [html("strong", {}, "Not as expected"), html("ul", {}, verdict.map((one) => html("li", {}, one)))] : html("strong", {}, "As expected"));
  }

  controls(part) {
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.whole = part("whole");
    this.whole.addEventListener("click", () => (this.home ? this.look(this.live ? this.model.seconds : 0) : this.goHome()));
    this.play = part("play");
    this.play.addEventListener("click", () => this.toggle());
    part("before").addEventListener("click", () => this.step(-1));
    part("after").addEventListener("click", () => this.step(1));
    window.addEventListener("resize", () => this.draw());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (/^(INPUT|SELECT|BUTTON|TEXTAREA|SUMMARY)$/.test(event.target.tagName) || event.ctrlKey || event.altKey || event.metaKey) return;
    const act = { " ": () => this.toggle(), ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** Go to the next or previous cycle. */
  step(by) {
    const moments = [0, ...this.model.cycles.map((cycle) => cycle.time), this.model.seconds];
    const here = !this.home ? this.time : this.live ? this.model.seconds : -1;
    const other = by > 0 ? moments.find((time) => time > here + 1e-6) : moments.filter((time) => time < here - 1e-6).pop();
    if (other !== undefined) this.seek(other);
  }

  toggle() {
    if (this.playing !== null) {
      window.cancelAnimationFrame(this.playing);
      this.playing = null;
    } else {
      if (this.home || this.time >= this.model.seconds) this.seek(0);
      let last = null;
      const frame = (now) => {
        const speed = Number(document.getElementById("speed").value);
        if (last === null || now - last >= 50) {
          this.seek(this.time + (last === null ? 0 : ((now - last) / 1000) * speed));
          last = now;
        }
        if (!this.home && this.time < this.model.seconds) this.playing = window.requestAnimationFrame(frame);
        else if (this.playing !== null) this.toggle();
      };
      this.playing = window.requestAnimationFrame(frame);
    }
    this.play.textContent = this.playing === null ? "Play" : "Pause";
  }

  /** Show a moment; at the end, the live page follows the present again. */
  seek(time) {
    if (this.live && time >= this.model.seconds) this.goHome();
    else this.look(time);
  }

  look(time) {
    this.home = false;
    this.time = Math.min(Math.max(time, 0), this.model.seconds);
    this.show();
  }

  /** Show the whole run, or follow the present. */
  goHome() {
    if (this.playing !== null) this.toggle();
    this.home = true;
    this.time = this.live ? this.model.seconds : 0;
    this.show();
  }

  show() {
    const { seconds: end } = this.model;
    if (this.home && this.live) this.time = end;
    const cycle = this.model.cycles[this.model.cycleAt(this.time)];
    const whole = this.home && !this.live;
    const words = [whole ? "whole run, " : "", seconds(whole ? end : this.time), cycle && !whole ? ` · cycle ${cycle.cycle}` : ""];
    this.slider.value = this.time;
    redraw(this.clock, words, () => words.map((part, place) => html("span", { class: place === 1 ? null : "less" }, part)));
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    say(this.whole, this.live ? (this.home ? "Look back" : "Back to live") : "Whole run");
    this.whole.setAttribute("aria-pressed", String(whole));
    document.getElementById("controls").classList.toggle("following", this.home && this.live);
    say(document.getElementById("planhead"), whole ? "The run" : "Plan");
    this.draw();
  }

  draw() {
    const whole = this.home && !this.live;
    for (const view of this.views) view.draw(whole ? this.model.seconds : this.time, whole);
  }
}
