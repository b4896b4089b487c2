"use strict";
// Elements. All text of a run becomes text nodes, and is never interpreted as HTML.

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === "onclick") element.addEventListener("click", value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
  }
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined) {
      element.append(child instanceof Node ? child : document.createTextNode(String(child)));
    }
  }
  return element;
}

/** Create an HTML element with attributes and children; strings become text nodes. */
function html(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** Create an SVG element with attributes and children; strings become text nodes. */
function svg(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** Create a button; ``act`` is called by a click. */
function button(words, act, attributes) {
  return html("button", { type: "button", onclick: act, ...attributes }, words);
}

/** Create a list of pairs of a name and words. */
function definitions(pairs, attributes) {
  return html("dl", attributes, pairs.map(([name, words]) => [html("dt", {}, name), html("dd", {}, words)]));
}

/** Replace the children of an element. */
function show(element, ...children) {
  element.replaceChildren(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
}

/** Replace the children of an element by those of ``draw`` if ``what`` has changed since the last time; else it keeps its scroll position. */
function redraw(element, what, draw) {
  const key = JSON.stringify(what);
  if (element.shownKey === key) return;
  element.shownKey = key;
  show(element, draw());
}

/** Set the text of an element, if it differs. */
function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** A moment or a duration: "32.5 s", "2 min 5 s", "1 h 4 min". */
function seconds(value) {
  if (value < 60) return `${value.toFixed(1)} s`;
  const whole = Math.round(value);
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return hours ? `${hours} h ${minutes} min` : `${minutes} min ${rest} s`;
}

/** The same for times of a computer: "20 ms". */
function brief(value) {
  return value < 1 ? `${Math.round(1000 * value)} ms` : seconds(value);
}

/** A text for narrow places; who uses it gives the whole text as title. */
function short(text, most) {
  return text.length > most ? `${text.slice(0, Math.max(1, most - 1))}…` : text;
}

/** Words that a click opens; ``open`` has the keys of those that are open, which stay so. */
function fold(open, key, words, ...children) {
  const whole = html("details", { open: open.has(key) ? "" : null }, html("summary", {}, words), children);
  whole.addEventListener("toggle", () => (whole.open ? open.add(key) : open.delete(key)));
  return whole;
}

/** Words that open to show their terms, if there are some. */
function folded(words, terms, open, key) {
  return terms ? fold(open, key, words, html("code", {}, terms)) : words;
}

function count(number, one, many) {
  return `${number} ${number === 1 ? one : many}`;
}

/** Round marks of an axis, about the wanted number of them. */
function marks(from, to, wanted) {
  const rough = Math.max((to - from) / wanted, 1e-9);
  const power = 10 ** Math.floor(Math.log10(rough));
  return multiples(from, to, power * ([1, 2, 5, 10].find((one) => one * power >= rough) || 10));
}

const TIMES = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400];

/** Round moments, about the wanted number of them: pairs of seconds and words. */
function moments(from, to, wanted) {
  const rough = (to - from) / wanted;
  const step = TIMES.find((one) => one >= rough) || 86400 * Math.ceil(rough / 86400);
  const found = rough < 0.5 ? marks(from, to, wanted) : multiples(from, to, step);
  return found.map((at) => [at, seconds(at).replace(".0 s", " s").replace(/ 0 (s|min)$/, "")]);
}

function multiples(from, to, step) {
  const found = [];
  for (let at = Math.ceil(from / step) * step; at <= to + 1e-9; at += step) found.push(Number(at.toFixed(6)));
  return found;
}
