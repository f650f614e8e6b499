/* A path drawn by hand: force, loss and all outputs along it. */

const POINTS = 800;

class Path {
  /** names: of the inputs that move. */
  constructor(place, joint, lab, names) {
    this.joint = joint;
    this.lab = lab;
    this.inputs = names.map((name) => joint.variables.get(name));
    this.force = joint.variables.get(joint.about.pairs[this.inputs[0].name]);
    this.loss = joint.about.variables.find((v) => v.causality === "output" && v.unit === "J" && /loss/.test(v.name));
    this.points = [];
    this.size = 0.5;
    this.amplitude = element("input", { type: "range", min: 1, max: 100, value: 50, id: "amplitude", oninput: () => (this.size = Number(this.amplitude.value) / 100) });
    const button = (text, act) => element("button", { type: "button", onclick: act }, text);
    const { path, pairs } = joint.about, ways = [path, ...Object.keys(pairs).filter((name) => path.length > 1 || name !== path[0]).map((name) => [name])];
    const moved = element("select", { id: "moved", onchange: () => lab.follow(ways[Number(moved.value)]) }, ...ways.map((way, i) => element("option", { value: i, selected: way.join() === names.join() }, way.map((name) => `${name}: ${joint.variables.get(name).doc.split(/[,;:(]/)[0].trim()}`).join("; "))));
    place.append(element("div", { class: "row" },
      ...(ways.length > 1 ? [element("label", { for: "moved" }, "Varied input"), moved] : []), element("label", { for: "amplitude" }, "Size of the loop"), this.amplitude, button("Back and forth", () => this.loop()),
      ...(this.inputs.length > 1 ? [button("Circle", () => this.circle())] : []), button("Clear the path", () => this.clear())));
    const places = element("div", { class: "charts" });
    place.append(places);
    const across = this.inputs[1] ? ` and ${this.inputs[1].name}` : "";
    this.pad = new Chart(places, `Draw here: ${this.inputs[0].name}${across}`, `Press and draw, or use the arrow keys; the path continues from the present position. ${this.inputs.map((v) => `${v.name}: ${v.doc}`).join("; ")}.`);
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
    if (this.trace.force.every((force) => force === 0)) { // inside the backlash
      this.size = 1;
      this.amplitude.value = 100;
      this.loop();
    }
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
    const others = this.inputs.slice(1).map(() => 0);
    this.clear();
    if (low >= 0) this.add(Array.from({ length: 20 }, (_, i) => [(place(0) * (i + 1)) / 20, ...others])); // no jump
    this.add(Array.from({ length: 200 }, (_, i) => [place(turn(i + 1)), ...others]));
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
    this.heat.note.textContent = loss.some((energy) => energy) ? this.loss.doc : "No loss along this path: the parameters state no friction, or nothing slips.";
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
