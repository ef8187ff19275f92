// What the modules of the page share.

export const $ = (id) => document.getElementById(id);

// `form`: groups of fields, units, codes, library and presets. `content`: the tables of the case, as in a case file.
// `grid`: the grid that the program has chosen if the case has none. `curve`: the curve that is drawn: `preview` says
// in words what a preview leaves out, and `errors` which errors are known. While the curve of the case replaces a
// preview, from its shallow end, `under` is the preview below it. `cursor`: index of the depth; null: the deepest.
export const state = {
  form: null, content: {}, grid: null, cursor: null, pins: [],
  curve: { rows: [], figures: {}, errors: "", preview: "", under: null, between: null, sticking: {} },
};

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(key, "");
    else if (value !== null && value !== false) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export function button(words, act, attributes = {}) {
  const made = element("button", { type: "button", ...attributes }, words);
  made.addEventListener("click", act);
  return made;
}

// A table whose cells are texts, nodes, or numbers { value, text }.
export function fill(id, names, rows) {
  const cell = (one) => (one instanceof Node ? element("td", {}, one)
    : one && one.text !== undefined ? element("td", { class: "number", "data-value": one.value }, one.text) : element("td", {}, one));
  const head = element("thead", {}, element("tr", {}, ...names.map((name) => element("th", { scope: "col" }, name))));
  $(id).replaceChildren(head, element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell)))));
}

export const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
