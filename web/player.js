"use strict";
// All views of a run, finished or live, at the moment of the slider.

class Player {
  constructor(model) {
    this.model = model;
    this.time = model.seconds;
    this.following = true; // follows the end of the run
    const seek = (time) => this.seek(time);
    const part = (name) => document.getElementById(name);
    this.goals = new GoalsView(part("goals"), model);
    this.views = [
      new MapView(part("map"), model),
      new TimelineView(part("timeline"), model, seek),
      this.goals,
      new CycleView(part("cycle"), model),
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
    if (this.following) this.seek(this.model.seconds);
    else this.draw();
  }

  title() {
    const { title, source, verdict, lacks } = this.model.about;
    document.title = title || "A run";
    say(document.getElementById("title"), title || "A run");
    const found = figures(this.model);
    const ends = [...found.ends].map(([word, number]) => `${number} ${word}`).join(", ");
    const words = [
      `${count(this.model.goals.length, "goal", "goals")}${ends ? `: ${ends}` : ""}`,
      seconds(this.model.seconds),
      count(this.model.cycles.length, "cycle", "cycles"),
      found.metres === null ? null : `${found.metres.toFixed(1)} m driven`,
      this.model.timed ? `solver ${brief(found.total)}` : null,
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
    this.play = part("play");
    this.play.addEventListener("click", () => this.toggle());
    part("before").addEventListener("click", () => this.step(-1));
    part("after").addEventListener("click", () => this.step(1));
    window.addEventListener("resize", () => this.draw());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (/^(INPUT|SELECT|BUTTON|TEXTAREA)$/.test(event.target.tagName) || event.ctrlKey || event.altKey || event.metaKey) return;
    const act = { " ": () => this.toggle(), ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** Go to the next or previous cycle. */
  step(by) {
    const moments = [0, ...this.model.cycles.map((cycle) => cycle.time), this.model.seconds];
    const other = by > 0 ? moments.find((time) => time > this.time + 1e-6) : moments.filter((time) => time < this.time - 1e-6).pop();
    if (other !== undefined) this.seek(other);
  }

  toggle() {
    if (this.playing !== null) {
      window.cancelAnimationFrame(this.playing);
      this.playing = null;
    } else {
      if (this.time >= this.model.seconds) this.seek(0);
      let last = null;
      const frame = (now) => {
        const speed = Number(document.getElementById("speed").value);
        if (last === null || now - last >= 50) {
          this.seek(this.time + (last === null ? 0 : ((now - last) / 1000) * speed));
          last = now;
        }
        if (this.time < this.model.seconds) this.playing = window.requestAnimationFrame(frame);
        else this.toggle();
      };
      this.playing = window.requestAnimationFrame(frame);
    }
    this.play.textContent = this.playing === null ? "Play" : "Pause";
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.model.seconds);
    this.following = this.time >= this.model.seconds;
    this.slider.value = this.time;
    const cycle = this.model.cycles[this.model.cycleAt(this.time)];
    this.clock.textContent = `${seconds(this.time)}${cycle ? ` · cycle ${cycle.cycle}` : ""}`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.draw();
  }

  draw() {
    for (const view of this.views) view.draw(this.time);
  }
}
