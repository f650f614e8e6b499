/* Numbers, units and elements as a reader meets them. */

const unitText = (unit) => (unit === "1" ? "" : unit.replaceAll(".", " ").replaceAll(/\bu(?=[mNsJr])/g, "µ"));
const withUnit = (name, unit) => (unit === "1" ? name : `${name} [${unitText(unit)}]`);
function digits(x, n = 4) {
  if (!Number.isFinite(x)) return "–";
  const size = Math.abs(x), short = Number(x.toPrecision(n));
  const text = size >= 1e6 || (size > 0 && size < 1e-4) ? short.toExponential().replace("e+", "e") : String(short);
  return text.replaceAll("-", "−");
}
/** A number that an input element takes. */
const entered = (x) => String(Number(Number(x).toPrecision(6)));

/** An element with attributes and children; `on...` attributes are functions. */
function element(tag, attributes = {}, ...children) {
  const svg = SVG_TAGS.has(tag);
  const made = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}
const SVG_TAGS = new Set(["svg", "g", "path", "line", "text", "circle", "rect", "title", "polygon", "clipPath"]);

/** A table of rows with a caption, numbers to the right. */
function table(caption, heads, rows) {
  const cell = (tag, x) => element(tag, typeof x === "number" ? { class: "n" } : {}, typeof x === "number" ? digits(x, 5) : x);
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption },
    element("table", {}, element("caption", {}, caption),
      element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head)))),
      element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map((x) => cell("td", x)))))));
}

/** Hand a file to the reader. */
function download(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
