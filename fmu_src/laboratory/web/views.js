/* What is seen of a joint: its curves, a path drawn by hand, the pressure on its contact, a body that rings on it. */

const [STEPS, COARSE] = [120, 40];
const POINTS = 800;
const [PER_PERIOD, PERIODS] = [40, 14];

/** Displayed numbers and label of a variable. */
const shown = (v, values) => values.map((x) => x * v.factor);
const label = (v) => withUnit(v.name, v.shown);

/** The load ramp from rest: { name: values } of all outputs and the driven input; what is refused ends it. */
function ramp(joint, values, end, steps, also = () => {}) {
  const driven = joint.about.ramp.input, names = joint.about.variables.filter((v) => v.causality === "output").map((v) => v.name);
  const found = Object.fromEntries([driven, ...names].map((name) => [name, []]));
  if (!joint.begin(new Map(values).set(driven, 0))) return found;
  for (let i = 0; i <= steps; i++) {
    const x = (end * i) / steps;
    if (i && !joint.step({ [driven]: x })) break;
    found[driven].push(x);
    for (const name of names) found[name].push(joint.get(name));
    also(x);
  }
  return found;
}

class Curves {
  constructor(place, joint) {
    this.joint = joint;
    this.panels = joint.about.panels.map((panel) => {
      const over = joint.variables.get(panel.over), quantities = panel.quantities.map((name) => joint.variables.get(name));
      return { over, quantities, chart: new Chart(place, `${panel.quantities.join(", ")} over ${panel.over}`, quantities.map((v) => v.doc).join("; ")) };
    });
  }

  /** A panel; found: the ramp. */
  draw({ over, quantities, chart }, lab, found) {
    const { now } = lab;
    const series = quantities.map((v) => ({ name: v.name, x: shown(over, found[over.name]), y: shown(v, found[v.name]) }));
    const first = quantities[0];
    if (now[over.name] * over.factor <= Math.max(...series[0].x, 0) && now[over.name] >= 0)
      quantities.forEach((v, k) => series.push({ name: "at the sliders", x: [now[over.name] * over.factor], y: [now[v.name] * v.factor], marks: "full", size: 5, colour: COLOURS[k], quiet: k > 0, titles: [`${v.name} at the sliders`] }));
    series.push(...this.published(over, quantities), ...this.measured(over, quantities, lab), ...dropped(lab.file, over, first, false));
    const log = series.some((s) => s.faint);
    chart.draw(series, { label: label(over), log }, { label: quantities.length > 1 ? `[${unitText(first.shown)}]` : label(first), log });
  }

  published(over, quantities) {
    const fitting = this.joint.about.points.filter((p) => over.name in p.at && quantities.some((v) => v.name === p.output));
    const roles = [...new Set(fitting.map((p) => p.role))];
    return roles.map((role) => {
      const some = fitting.filter((p) => p.role === role);
      return { name: `published: ${some[0].doc}`, marks: role === "calibration" ? "empty" : "full", colour: "var(--ink)",
        x: some.map((p) => p.at[over.name] * over.factor), y: some.map((p) => p.value * this.joint.variables.get(p.output).factor), titles: some.map((p) => `${p.id}: ${p.place}`) };
    });
  }

  measured(over, quantities, lab) {
    const some = this.joint.about.measured.filter((m) => m.over === over.name && quantities.some((v) => v.name === m.quantity));
    return some.map((m, k) => {
      const v = this.joint.variables.get(m.quantity), times = lab.values.get(m.times) * v.factor;
      return { name: k ? `measured: ${m.label}` : "measured joints, each named in the table", quiet: k > 0, titles: m.x.map(() => `measured: ${m.label} (${m.source})`), x: shown(over, m.x), y: m.y.map((y) => y * times), dashed: true, faint: true, colour: `hsl(${(k * 67) % 360} 35% 55%)` };
    });
  }
}

/** The curve of a dropped file over two variables that measure what it measures; as it goes round if `free`. */
function dropped(file, one, other, free) {
  if (!file) return [];
  const [x, y] = [one, other].map((v) => file.columns.find((c) => c.base === v.unit && !(free && c.used)));
  if (!x || !y || x === y) return [];
  return [{ name: `file: ${file.name}`, x: shown(one, x.values), y: shown(other, y.values), marks: "empty", size: 2.5, colour: "var(--violet)" }];
}

class Path {
  constructor(place, joint, lab) {
    this.joint = joint;
    this.lab = lab;
    this.inputs = joint.about.path.map((name) => joint.variables.get(name));
    this.force = joint.variables.get(joint.about.pairs[this.inputs[0].name]);
    this.loss = joint.about.variables.find((v) => v.causality === "output" && v.unit === "J" && /loss/.test(v.name));
    this.points = [];
    this.size = 0.5;
    this.amplitude = element("input", { type: "range", min: 1, max: 100, value: 50, id: "amplitude", oninput: () => (this.size = Number(this.amplitude.value) / 100) });
    const button = (text, act) => element("button", { type: "button", onclick: act }, text);
    place.append(element("div", { class: "row" },
      element("label", { for: "amplitude" }, "Size of the loop"), this.amplitude, button("Loop to and fro", () => this.loop()),
      ...(this.inputs.length > 1 ? [button("Round in a circle", () => this.circle())] : []), button("Clear the path", () => this.clear())));
    const places = element("div", { class: "charts" });
    place.append(places);
    const across = this.inputs[1] ? ` and ${this.inputs[1].name}` : "";
    this.pad = new Chart(places, `Draw here: ${this.inputs[0].name}${across}`, `Press and draw, or use the arrow keys; the joint follows from where it is. ${this.inputs.map((v) => `${v.name}: ${v.doc}`).join("; ")}.`);
    this.pad.svg.classList.add("pad");
    this.pad.svg.setAttribute("role", "application");
    for (const type of ["point", "key", "zoomTo"]) this.pad[type] = () => {};
    this.pad.svg.addEventListener("pointerdown", (event) => { this.pad.svg.setPointerCapture(event.pointerId); this.drawing = true; this.drag(event); });
    this.pad.svg.addEventListener("pointermove", (event) => this.drawing && this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) this.pad.svg.addEventListener(end, () => (this.drawing = false));
    this.pad.svg.addEventListener("keydown", (event) => this.arrow(event));
    this.answer = new Chart(places, `${this.force.name} along the path`, this.force.doc);
    this.heat = this.loss && new Chart(places, `${this.loss.name} along the path`, this.loss.doc);
    this.now = element("div", { class: "now" });
    places.append(this.now);
    this.loop();
  }

  /** The path is gone again once for all that shows it. */
  views() {
    let gone = false;
    const once = (draw) => () => {
      if (!gone) this.replay();
      gone = true;
      draw();
    };
    const places = [[this.pad.figure, this.showPad], [this.answer.figure, this.showAnswer], ...(this.heat ? [[this.heat.figure, this.showHeat]] : []), [this.now, this.showOutputs]];
    return places.map(([place, draw]) => ({ place, show: once(() => draw.call(this)) }));
  }

  /** The path again from rest, with the present values. */
  replay() {
    this.trace = { at: [], force: [], loss: [] };
    this.joint.messages.clear();
    const start = new Map(this.lab.values);
    for (const v of this.inputs) start.set(v.name, 0);
    this.good = this.joint.begin(start);
    if (this.good) this.note();
    for (const point of this.points) this.go(point);
    this.started = this.joint.starts;
    this.messages = new Set(this.joint.messages);
  }

  go(point) {
    if (!this.good) return;
    this.good = this.joint.step(Object.fromEntries(this.inputs.map((v, i) => [v.name, point[i]])));
    if (this.good) this.note();
  }

  note() {
    this.trace.at.push(this.inputs.map((v) => this.joint.get(v.name)));
    this.trace.force.push(this.joint.get(this.force.name));
    if (this.loss) this.trace.loss.push(this.joint.get(this.loss.name));
  }

  /** On to other points, from where the path ends; gone again first, if the joint was elsewhere. */
  add(points) {
    if (this.started !== this.joint.starts) this.replay();
    for (const point of points) {
      if (this.points.length >= POINTS) break;
      this.points.push(point);
      this.go(point);
    }
    this.messages = new Set(this.joint.messages);
    this.show();
  }

  drag(event) {
    const box = this.pad.svg.getBoundingClientRect();
    const [first, second] = this.inputs;
    const events = event.getCoalescedEvents?.() || [];
    this.add((events.length ? events : [event]).map((e) => {
      const [x, y] = this.pad.scale.back(((e.clientX - box.left) * this.pad.scale.width) / box.width, ((e.clientY - box.top) * this.pad.scale.height) / box.height);
      return second ? [x / first.factor, y / second.factor] : [x / first.factor];
    }));
  }

  arrow(event) {
    const [dx, dy] = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] || [0, 0];
    if (!dx && !(dy && this.inputs[1])) return;
    event.preventDefault();
    const last = this.points.at(-1) || this.inputs.map(() => 0);
    this.add([last.map((x, i) => x + ([dx, dy][i] * this.inputs[i].span[1]) / 50)]);
    const { at, force } = this.trace, [v] = this.inputs;
    this.pad.reading.textContent = `${label(v)}: ${digits(at.at(-1)[0] * v.factor)}; ${label(this.force)}: ${digits(force.at(-1) * this.force.factor)}`;
  }

  loop() {
    const [low, high] = this.inputs[0].span.map((end) => this.size * end), turn = (i) => (i <= 40 ? i / 40 : i <= 120 ? 2 - i / 40 : i / 40 - 4);
    const place = (t) => (low < 0 ? high * t : 0.5 * high * (1 + t));
    this.clear();
    this.add(Array.from({ length: 200 }, (_, i) => [place(turn(i + 1)), ...this.inputs.slice(1).map(() => 0)]));
  }

  circle() {
    const most = this.size * this.inputs[0].span[1];
    this.clear();
    this.add(Array.from({ length: 280 }, (_, i) => {
      const angle = (2 * Math.PI * (i - 20)) / 120;
      return i < 20 ? [(most * (i + 1)) / 20, 0] : [most * Math.cos(angle), most * Math.sin(angle)];
    }));
  }

  clear() {
    this.points = [];
    this.replay();
    this.show();
  }

  show() {
    this.showPad();
    this.showAnswer();
    if (this.heat) this.showHeat();
    this.showOutputs();
    this.lab.tell();
  }

  /** Where the path went, along one of its inputs. */
  along(k) {
    return this.trace.at.map((p) => p[k] * this.inputs[k].factor);
  }

  showPad() {
    const [first, second] = this.inputs, along = (v) => v.span.map((end) => end * v.factor);
    const x = this.along(0), y = second ? this.along(1) : x.map(() => 0);
    const end = { name: "now", x: x.slice(-1), y: y.slice(-1), marks: "full", size: 6, colour: "var(--red)" };
    this.pad.draw([{ name: "path", x, y }, end], { label: label(first), range: along(first) }, { label: second ? label(second) : "", range: second ? along(second) : [-1, 1], hidden: !second });
  }

  showAnswer() {
    const [first] = this.inputs, x = this.along(0), answer = shown(this.force, this.trace.force);
    this.answer.draw([{ name: this.force.name, x, y: answer }, { name: "now", x: x.slice(-1), y: answer.slice(-1), marks: "full", size: 6, colour: "var(--red)" }, ...dropped(this.lab.file, first, this.force, true)], { label: label(first) }, { label: label(this.force) });
  }

  showHeat() {
    const { loss } = this.trace;
    this.heat.draw([{ name: this.loss.name, x: loss.map((_, i) => i), y: shown(this.loss, loss) }], { label: "points of the path" }, { label: label(this.loss) });
  }

  showOutputs() {
    const [first] = this.inputs, { at, force } = this.trace;
    const work = at.reduce((sum, p, i) => (i ? sum + 0.5 * (force[i] + force[i - 1]) * (p[0] - at[i - 1][0]) : 0), 0);
    const outputs = this.good ? this.joint.about.variables.filter((v) => v.causality === "output").map((v) => [v.name, this.joint.get(v.name) * v.factor, unitText(v.shown), v.doc]) : [];
    const rows = [...outputs, [`∫ ${this.force.name} d${first.name}`, work, "J", "work of this output along the path"]];
    const cells = this.now.querySelectorAll("td.n");
    if (cells.length === rows.length) rows.forEach((row, i) => (cells[i].textContent = digits(row[1], 5)));
    else this.now.replaceChildren(table("All outputs at the end of the path", ["output", "value", "unit", "meaning"], rows));
  }
}

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

/** Which places are in the window, or nearly so. */
class Sight {
  constructor() {
    this.seen = new Set();
    this.known = new Set();
    this.watcher = new IntersectionObserver((changes) => {
      for (const { target, isIntersecting } of changes) this.seen[isIntersecting ? "add" : "delete"](target);
    }, { rootMargin: "100px" });
  }

  /** A place that was never asked for counts as seen. */
  sees(place) {
    if (this.known.has(place)) return this.seen.has(place);
    this.known.add(place);
    this.watcher.observe(place);
    return true;
  }
}

class Body {
  constructor(place, joint, lab) {
    this.joint = joint;
    this.lab = lab;
    const about = joint.about;
    this.input = joint.variables.get(about.path[0]);
    this.output = joint.variables.get(about.pairs[this.input.name]);
    this.moves = ["m", "rad"].includes(this.input.unit);
    this.turns = [this.input.unit, this.output.unit].includes("rad");
    const ending = this.input.name.match(/(_[xyz]|\d+)$/)?.[0] || "";
    this.rate = about.variables.find((v) => v.causality === "input" && v.unit === `${this.input.unit}/s` && v.name.endsWith(ending));
    const body = { name: this.turns ? "body inertia" : "body mass", doc: "of the body on the joint", unit: this.turns ? "kg.m2" : "kg", shown: this.turns ? "kg.m2" : "kg", factor: 1, span: this.turns ? [1e-3, 10] : [1, 1000], log: true };
    this.inertia = this.turns ? 0.1 : 60;
    this.pulled = 0.2;
    const controls = [new Control(body, this.inertia, (x) => { if (x > 0) { this.inertia = x; lab.redraw(); } })];
    const half = this.input.span[1];
    if (this.moves) controls.push(new Control({ name: "pull", doc: `${this.input.name} from which it is let go, beside the slider's`, unit: this.input.unit, shown: this.input.shown, factor: this.input.factor, span: [0.002 * half, half], log: true }, (this.pull = this.pulled * half), (x) => { this.pull = x; lab.redraw(); }));
    place.append(element("div", { class: "row bodies" }, ...controls.map((c) => c.node)));
    const charts = element("div", { class: "charts" });
    place.append(charts);
    this.over = new Chart(charts, "Resonance over the load", `Square root of |d${this.output.name}/d${this.input.name}|${this.moves ? "" : " (its inverse)"} over the ${this.turns ? "inertia" : "mass"}, along the load ramp.`);
    this.decay = this.moves && new Chart(charts, "Let go", "");
  }

  /** Tangent stiffness at the present state. */
  stiffness() {
    const slope = Math.abs(this.joint.derivative(this.output.name, this.input.name));
    return this.moves ? slope : 1 / slope;
  }

  views(steps) {
    const over = { place: this.over.figure, show: () => this.resonance(steps / 2), ramp: true };
    return [over, ...(this.decay ? [{ place: this.decay.figure, show: () => this.letGo() }] : [])];
  }

  resonance(steps) {
    const { joint, lab } = this, stiffness = [];
    const values = ramp(joint, lab.values, lab.end, steps, () => stiffness.push(this.stiffness()));
    const found = stiffness.map((K) => Math.sqrt(K / this.inertia) / (2 * Math.PI));
    const same = joint.about.ramp.input === this.input.name && this.moves;
    const load = same ? this.output : joint.variables.get(joint.about.ramp.input);
    const x = shown(load, values[load.name]).map(same ? Math.abs : (v) => v);
    this.over.draw([{ name: "resonance", x, y: found }], { label: withUnit(same ? `|${load.name}|` : load.name, load.shown) }, { label: "resonance [Hz]" });
  }

  /** Free motion by the velocity Verlet scheme; the force at the sliders is held against. */
  letGo() {
    const { joint, input, output, rate, inertia } = this, start = new Map(this.lab.values), rest = start.get(input.name);
    this.decay.note.textContent = "";
    if (!joint.begin(start)) return;
    const held = joint.get(output.name), K = this.stiffness();
    if (!(K > 0)) {
      this.decay.draw([], { label: "time [ms]" }, { label: label(input) });
      this.decay.note.textContent = "At the sliders the joint has no stiffness; nothing rings.";
      return;
    }
    const step = (2 * Math.PI) / Math.sqrt(K / inertia) / PER_PERIOD, time = [], moved = [];
    const force = (u, v) => joint.step({ [input.name]: rest + u, ...(rate ? { [rate.name]: v } : {}) }) ? (joint.get(output.name) - held) / inertia : NaN;
    let [u, v] = [this.pull, 0], a = force(u, v);
    for (let i = 0; i <= PER_PERIOD * PERIODS && Number.isFinite(a); i++) {
      time.push(1e3 * i * step);
      moved.push(u * input.factor);
      u += step * (v + 0.5 * step * a);
      const next = force(u, v + step * a);
      v += 0.5 * step * (a + next);
      a = next;
    }
    this.decay.draw([{ name: input.name, x: time, y: moved }], { label: "time [ms]" }, { label: `${input.name} from the slider's [${unitText(input.shown)}]` });
    this.decay.note.textContent = decayText(time, moved);
  }
}

/** Frequency and damping of a decay by its upward crossings and its peaks. */
function decayText(time, moved) {
  const up = [], peaks = [moved[0]];
  for (let i = 1; i < moved.length; i++) {
    if (moved[i - 1] < 0 && moved[i] >= 0) up.push(time[i - 1] + ((time[i] - time[i - 1]) * -moved[i - 1]) / (moved[i] - moved[i - 1]));
    if (i + 1 < moved.length && moved[i] > 0 && moved[i] >= moved[i - 1] && moved[i] > moved[i + 1]) peaks.push(moved[i]);
  }
  if (up.length < 2 || peaks.length < 3) return "It does not swing.";
  const hertz = (1e3 * (up.length - 1)) / (up.at(-1) - up[0]);
  const ratio = Math.log(peaks[0] / peaks.at(-1)) / (2 * Math.PI * (peaks.length - 1));
  return `It swings with ${digits(hertz)} Hz; damping ratio ${digits(100 * ratio, 3)} % over the swings shown.`;
}
