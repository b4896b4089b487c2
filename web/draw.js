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

/** Replace the children of an element. */
function show(element, ...children) {
  element.replaceChildren(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
}

/** Set the text of an element, if it differs. */
function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

function seconds(value) {
  if (value < 60) return `${value.toFixed(1)} s`;
  const whole = Math.round(value);
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return hours ? `${hours} h ${minutes} min` : `${minutes} min ${rest} s`;
}

function brief(value) {
  return value < 1 ? `${Math.round(1000 * value)} ms` : seconds(value);
}

/** A shortened text for narrow places, with the whole text as its title. */
function short(text, most) {
  return text.length > most ? `${text.slice(0, Math.max(1, most - 1))}…` : text;
}

function count(number, one, many) {
  return `${number} ${number === 1 ? one : many}`;
}

/** Details that stay open or closed while views are drawn again; none for an empty text. */
function details(text) {
  return text ? html("details", {}, html("summary", {}, "details"), html("code", {}, text)) : null;
}

/** A round distance between marks of an axis, for about the wanted number of marks. */
function marks(from, to, wanted) {
  const rough = Math.max((to - from) / wanted, 1e-9);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((one) => one * power >= rough) || 10);
  const found = [];
  for (let at = Math.ceil(from / step) * step; at <= to + 1e-9; at += step) found.push(Number(at.toFixed(6)));
  return found;
}
