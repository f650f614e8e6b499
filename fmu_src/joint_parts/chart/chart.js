/* A chart: lines and marks over two axes as SVG, read by pointer, by keyboard and as a table. */

const COLOURS = ["blue", "red", "green", "violet", "ochre", "grey"].map((name) => `var(--${name})`);
const MARGIN = { left: 72, right: 14, top: 10, bottom: 44 };

/** What a picture takes along of the page's style. */
const SHOWN = ["fill", "stroke", "stroke-width", "font-size", "font-family", "visibility"];

/** About n round numbers from low to high. */
function ticks(low, high, n) {
  const raw = (high - low) / n;
  const ten = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** Decades from low to high, and twos and fives where they are few. */
function decades(low, high) {
  const few = high / low < 300;
  const all = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e++) for (const k of few ? [1, 2, 5] : [1]) all.push(Number((k * 10 ** e).toPrecision(3)));
  return all.filter((x) => x >= low * 0.999 && x <= high * 1.001);
}

/** Low and high end of some numbers, with zero where it is near; of a logarithmic axis those above zero. */
function extent(values, { range, log }) {
  if (range) return range;
  if (log) {
    const some = values.filter((x) => x > 0 && Number.isFinite(x));
    return some.length ? [0.9 * Math.min(...some), 1.1 * Math.max(...some)] : [1, 10];
  }
  let [low, high] = [Infinity, -Infinity];
  for (const x of values) if (Number.isFinite(x)) [low, high] = [Math.min(low, x), Math.max(high, x)];
  if (!(low <= high)) return [0, 1];
  const flat = high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high));
  const room = flat ? 0.1 * Math.abs(high) || 1 : 0.05 * (high - low);
  const bottom = low >= 0 && low < 0.5 * high ? 0 : low - room;
  return [bottom, low < 0 && high <= 0 && high > 0.5 * low ? 0 : high + room];
}

/** Width of a picture, measured once for each size of the window: asking makes the browser lay out the page. */
function widthOf(picture) {
  if (picture.measured !== innerWidth) {
    const width = picture.svg.clientWidth; // 0 as long as it is hidden
    [picture.measured, picture.width] = [width && innerWidth, Math.max(280, width || 480)];
  }
  return picture.width;
}

class Chart {
  /** title and text say what is to be seen; x and y are the axes' labels. */
  constructor(parent, title, text = "") {
    const id = `chart${Chart.count = (Chart.count || 0) + 1}`;
    this.svg = element("svg", { class: "plot", role: "img", tabindex: 0, "aria-labelledby": id });
    this.reading = element("output", { class: "reading", "aria-live": "polite" });
    this.rows = element("details", { class: "values", ontoggle: () => this.tabulate() }, element("summary", {}, "Values as a table, CSV or PNG"),
      element("button", { type: "button", onclick: () => download(new Blob([this.csv()], { type: "text/csv" }), `${title}.csv`) }, "Save CSV"), " ",
      element("button", { type: "button", onclick: async () => download(await this.png(), `${title}.png`) }, "Save PNG"));
    this.legend = element("ul", { class: "legend" });
    this.title = title;
    this.note = element("p", { class: "note" }, text);
    this.figure = element("figure", {}, element("h3", { id }, title), this.legend, this.svg, this.reading, this.note, this.rows);
    this.at = -1;
    this.svg.addEventListener("pointerdown", (event) => (this.from = this.place(event)));
    this.svg.addEventListener("pointerup", (event) => this.zoomTo(this.from, this.place(event)));
    this.svg.addEventListener("dblclick", () => this.zoomTo());
    this.svg.addEventListener("pointermove", (event) => this.point(event));
    this.svg.addEventListener("pointerleave", () => this.read(-1));
    this.svg.addEventListener("keydown", (event) => this.key(event));
    parent.append(this.figure);
  }

  /** series: { name, x, y, marks, dashed, colour, titles, faint, quiet }; axes: { label, range, log, hidden }. */
  draw(series, x, y) {
    this.series = series.filter((s) => s.x.length);
    this.axes = [x, y];
    if (this.zoom) [x, y] = [{ ...x, range: this.zoom }, { ...y, range: y.range || this.within(y) }];
    const width = widthOf(this);
    const height = Math.round(Math.min(340, Math.max(220, 0.62 * width)));
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const [x0, x1] = extent(this.series.flatMap((s) => s.x), x);
    const [y0, y1] = extent(this.series.flatMap((s) => s.y), y);
    const right = width - MARGIN.right, bottom = height - MARGIN.bottom;
    const part = (v, low, high, log) => (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
    this.scale = {
      x: (v) => MARGIN.left + part(v, x0, x1, x.log) * (right - MARGIN.left),
      y: (v) => bottom - part(v, y0, y1, y.log) * (bottom - MARGIN.top),
      back: (px, py) => [x0 + ((px - MARGIN.left) / (right - MARGIN.left)) * (x1 - x0), y0 + ((bottom - py) / (bottom - MARGIN.top)) * (y1 - y0)],
      width, height,
    };
    const parts = [];
    for (const v of x.log ? decades(x0, x1) : ticks(x0, x1, width / 80)) {
      const at = this.scale.x(v).toFixed(1);
      parts.push(`<line class="grid" x1="${at}" x2="${at}" y1="${MARGIN.top}" y2="${bottom}"/><text class="tick" x="${at}" y="${bottom + 16}" text-anchor="middle">${digits(v)}</text>`);
    }
    for (const v of y.hidden ? [] : y.log ? decades(y0, y1) : ticks(y0, y1, 5)) {
      const at = this.scale.y(v).toFixed(1);
      parts.push(`<line class="grid" x1="${MARGIN.left}" x2="${right}" y1="${at}" y2="${at}"/><text class="tick" x="${MARGIN.left - 7}" y="${at}" dy="4" text-anchor="end">${digits(v)}</text>`);
    }
    parts.push(`<rect class="frame" x="${MARGIN.left}" y="${MARGIN.top}" width="${right - MARGIN.left}" height="${bottom - MARGIN.top}"/>`);
    parts.push(`<text class="label" x="${(MARGIN.left + right) / 2}" y="${height - 8}" text-anchor="middle">${escaped(x.label)}</text>`);
    parts.push(`<text class="label" transform="translate(13 ${(MARGIN.top + bottom) / 2}) rotate(-90)" text-anchor="middle">${escaped(y.label)}</text>`);
    parts.push(`<svg x="${MARGIN.left}" y="${MARGIN.top}" width="${right - MARGIN.left}" height="${bottom - MARGIN.top}" viewBox="${MARGIN.left} ${MARGIN.top} ${right - MARGIN.left} ${bottom - MARGIN.top}" overflow="hidden">`);
    this.series.forEach((s, k) => parts.push(this.drawn(s, k)));
    parts.push(`</svg><circle class="reader" r="5" visibility="hidden"/>`);
    this.svg.innerHTML = parts.join("");
    const told = this.series.map((s, k) => [s, k]).filter(([s]) => !s.quiet);
    const names = told.map(([s]) => s.name).join("\n");
    if (this.told !== names) this.legend.replaceChildren(...(told.length > 1 ? told.map(([s, k]) => legendRow(s, k)) : []));
    this.told = names;
    this.tabulate();
  }

  /** Where the pointer is, in the units of the x axis. */
  place(event) {
    const box = this.svg.getBoundingClientRect();
    return this.scale.back(((event.clientX - box.left) * this.scale.width) / box.width, 0)[0];
  }

  /** Show a part of the x axis that is wide enough to be meant; without ends the whole. */
  zoomTo(from, to) {
    const [low, high] = extent(this.series.flatMap((s) => s.x), this.axes[0]);
    const [left, right] = [Math.min(from, to), Math.max(from, to)];
    if (from !== undefined && !(right - left > 0.001 * (high - low))) return;
    this.zoom = from === undefined || this.axes[0].log ? null : [Math.max(left, low), Math.min(right, high)];
    this.draw(this.series, ...this.axes);
  }

  /** Range of the y axis for what is seen of the x axis. */
  within(y) {
    const [low, high] = this.zoom;
    return extent(this.series.flatMap((s) => s.y.filter((_, i) => s.x[i] >= low && s.x[i] <= high)), y);
  }

  drawn(s, k) {
    const colour = s.colour || COLOURS[k % COLOURS.length];
    const places = s.x.map((v, i) => [this.scale.x(v), this.scale.y(s.y[i])]).filter((p) => p.every(Number.isFinite));
    if (s.marks) {
      const fill = s.marks === "full" ? colour : "var(--paper)";
      return places.map((p, i) => `<circle cx="${p[0].toFixed(1)}" cy="${p[1].toFixed(1)}" r="${s.size || 4}" fill="${fill}" stroke="${colour}" stroke-width="1.6">${s.titles ? `<title>${escaped(s.titles[i])}</title>` : ""}</circle>`).join("");
    }
    const d = places.map((p, i) => `${i ? "L" : "M"}${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("");
    return `<path d="${d}" fill="none" stroke="${colour}" stroke-width="${s.faint ? 1.2 : 2}"${s.dashed ? ' stroke-dasharray="5 4"' : ""}>${s.faint ? `<title>${escaped(s.name)}</title>` : ""}</path>`;
  }

  /** Values at the point of the first line that is nearest to the pointer. */
  point(event) {
    const line = this.series && this.series[0];
    if (!line) return;
    const box = this.svg.getBoundingClientRect();
    const at = (event.clientX - box.left) * (this.scale.width / box.width), up = (event.clientY - box.top) * (this.scale.height / box.height);
    const far = (i) => (this.scale.x(line.x[i]) - at) ** 2 + 1e-3 * (this.scale.y(line.y[i]) - up) ** 2;
    let best = 0;
    for (let i = 1; i < line.x.length; i++) if (far(i) < far(best)) best = i;
    this.read(best);
  }

  key(event) {
    const line = this.series && this.series[0];
    if (!line) return;
    const [low, high] = this.zoom || extent(this.series.flatMap((s) => s.x), this.axes[0]);
    const middle = this.at >= 0 ? line.x[this.at] : (low + high) / 2;
    if (event.key === "+") return this.zoomTo(middle - (high - low) / 4, middle + (high - low) / 4);
    if (event.key === "-" || event.key === "Escape") return this.zoomTo();
    const move = { ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10, Home: -1e9, End: 1e9 }[event.key];
    if (!move) return;
    event.preventDefault();
    this.read(Math.min(line.x.length - 1, Math.max(0, Math.max(this.at, 0) + move)));
  }

  read(i) {
    this.at = i;
    const dot = this.svg.querySelector(".reader");
    if (!dot) return;
    dot.setAttribute("visibility", i < 0 ? "hidden" : "visible");
    if (i < 0) return void (this.reading.textContent = "");
    const first = this.series[0];
    dot.setAttribute("cx", this.scale.x(first.x[i]));
    dot.setAttribute("cy", this.scale.y(first.y[i]));
    const alike = this.series.filter((s) => !s.marks && s.x.length === first.x.length);
    this.reading.textContent = `${this.axes[0].label}: ${digits(first.x[i])}; ` + alike.map((s) => `${s.name} ${digits(s.y[i])}`).join(", ");
  }

  /** All points of all series, with the axes' labels. */
  csv() {
    const cell = (x) => (typeof x === "number" ? String(x) : `"${x.replaceAll('"', '""')}"`);
    const rows = this.series.flatMap((s) => s.x.map((v, i) => [s.titles ? s.titles[i] : s.name, v, s.y[i]]));
    return [["series", ...this.axes.map((axis) => axis.label)], ...rows].map((row) => row.map(cell).join(",") + "\n").join("");
  }

  /** A promise of the picture as it is shown, with title and legend, in twice its size. */
  async png() {
    const copy = this.svg.cloneNode(true), { width, height } = this.scale, top = 24 + 18 * this.legend.children.length;
    const parts = copy.querySelectorAll("*");
    this.svg.querySelectorAll("*").forEach((shown, i) => { for (const name of SHOWN) parts[i].style.setProperty(name, getComputedStyle(shown)[name]); });
    for (const [name, value] of Object.entries({ xmlns: this.svg.namespaceURI, width: 2 * width, height: 2 * height })) copy.setAttribute(name, value);
    const image = new Image();
    image.src = `data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
    await image.decode();
    const canvas = element("canvas", { width: 2 * width, height: 2 * (height + top) }), pen = canvas.getContext("2d"), page = getComputedStyle(document.body);
    pen.scale(2, 2);
    pen.fillStyle = page.getPropertyValue("--paper");
    pen.fillRect(0, 0, width, height + top);
    pen.font = `12px ${page.fontFamily}`;
    const write = (text, left, down, colour) => { pen.fillStyle = colour; pen.fillText(text, left, down); };
    write(this.title, MARGIN.left, 16, page.getPropertyValue("--ink"));
    [...this.legend.children].forEach((row, k) => write(`\u25a0 ${row.textContent}`, MARGIN.left, 34 + 18 * k, getComputedStyle(row.firstChild).borderTopColor));
    pen.drawImage(image, 0, top, width, height);
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }

  /** Fill the table if it is open, about 20 rows of each line and all marks. */
  tabulate() {
    this.rows.querySelector(".scroll")?.remove();
    if (!this.rows.open || !this.series) return;
    const rows = this.series.flatMap((s) => {
      const every = s.marks ? 1 : Math.max(1, Math.floor(s.x.length / 20));
      return s.x.map((v, i) => [s.titles ? s.titles[i] : s.name, v, s.y[i]]).filter((_, i) => i % every === 0 || i === s.x.length - 1);
    });
    this.rows.append(table(this.title, ["", this.axes[0].label, this.axes[1].label], rows));
  }
}

function legendRow(s, k) {
  const colour = s.colour || COLOURS[k % COLOURS.length];
  const sign = element("span", { class: s.marks ? `sign dot ${s.marks}` : s.dashed ? "sign dashes" : "sign", style: `--colour:${colour}`, "aria-hidden": "true" });
  return element("li", {}, sign, s.name);
}

const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");
