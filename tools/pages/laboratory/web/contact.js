/* The pressure on the contact. */

class PressureMap {
  constructor(place, joint) {
    this.joint = joint;
    this.about = joint.about.map;
    this.svg = element("svg", { class: "plot", role: "img", "aria-label": this.about.name });
    this.text = element("p", { class: "note" });
    this.rows = element("details", { class: "values", ontoggle: () => this.tabulate() }, element("summary", {}, "Values as a table"));
    this.figure = element("figure", {}, element("h3", {}, this.about.name), this.svg, this.text, this.rows);
    place.append(this.figure);
  }

  draw(values) {
    this.joint.begin(values);
    const rows = (this.rowsShown = this.joint.map());
    if (!rows.length) return void this.svg.replaceChildren();
    const all = [...rows.map(([x, y]) => [x, y]), ...this.about.marks];
    const [xs, ys] = [0, 1].map((k) => all.map((p) => p[k]));
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const width = widthOf(this), inner = width - 30;
    const per = inner / Math.max(x1 - x0, 0.6 * (y1 - y0)), height = (y1 - y0) * per + 84;
    const left = (width - (x1 - x0) * per) / 2;
    const at = (x, y) => [left + (x - x0) * per, 15 + (y1 - y) * per];
    const p = rows.map((row) => row[3] * this.about.factor), most = Math.max(...p), least = Math.min(...p);
    const greatest = Math.max(...rows.map((row) => row[2]));
    const shade = (v) => `hsl(${250 - 200 * v} 75% ${30 + 35 * v}%)`;
    const spots = rows.map(([x, y, share, value], i) => {
      const [px, py] = at(x, y), r = 3 + 7 * Math.sqrt(share / greatest);
      return `<circle cx="${px.toFixed(1)}" cy="${py.toFixed(1)}" r="${r.toFixed(1)}" fill="${value > 0 ? shade(most > least ? (p[i] - least) / (most - least) : 0.5) : "none"}" stroke="var(--rule)" stroke-width=".7"><title>${digits(p[i])} ${unitText(this.about.shown)}</title></circle>`;
    });
    const marks = this.about.marks.map(([x, y]) => at(x, y)).map(([px, py]) => `<circle cx="${px.toFixed(1)}" cy="${py.toFixed(1)}" r="4" fill="var(--paper)" stroke="var(--ink)" stroke-width="1.5"/>`);
    const bar = Array.from({ length: 40 }, (_, i) => `<rect x="${width / 2 - 100 + 5 * i}" y="${height - 42}" width="5.3" height="12" fill="${shade(i / 39)}"/>`);
    const ends = `<text class="tick" x="${width / 2 - 100}" y="${height - 14}" text-anchor="middle">${digits(least)}</text><text class="tick" x="${width / 2 + 100}" y="${height - 14}" text-anchor="middle">${digits(most)} ${unitText(this.about.shown)}</text>`;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height.toFixed(0)}`);
    this.svg.innerHTML = [...spots, ...marks, ...bar, ends].join("");
    this.text.textContent = `At the sliders: ${digits(least)} to ${digits(most)} ${unitText(this.about.shown)} ${this.about.doc}; the size of a spot is its share of the area.${this.about.what ? ` Rings: ${this.about.what}.` : ""}`;
    this.tabulate();
  }

  tabulate() {
    this.rows.querySelector(".scroll")?.remove();
    if (!this.rows.open || !this.rowsShown) return;
    const unit = unitText(this.about.shown);
    this.rows.append(table(this.about.name, ["x [mm]", "y [mm]", "share [%]", `${this.about.name} [${unit}]`], this.rowsShown.map(([x, y, s, p]) => [1e3 * x, 1e3 * y, 100 * s, p * this.about.factor])));
  }
}
