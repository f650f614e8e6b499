/* The page: one joint at a time, its values, and what is redrawn when they change. */

/** How long a slider rests before what is out of sight is drawn, and how long that takes before the page listens again [ms]. */
const [PAUSE, SLICE] = [120, 6];
const at = (id) => document.getElementById(id);

class Laboratory {
  constructor(known) {
    this.known = known;
    this.file = null;
    this.opened = [];
    this.said = new Set();
    const models = [...new Set(known.modules.map((m) => m.name))];
    at("model").append(...models.map((name) => element("option", { value: name }, `${known.modules.find((m) => m.name === name).title}: ${name}`)));
    at("model").onchange = () => this.leave(at("model").value, 0);
    at("set").onchange = () => this.leave(at("model").value, Number(at("set").value));
    at("reset").onclick = () => this.take(this.set);
    at("example").onclick = () => this.change(this.about.example.values, this.about.example.doc);
    at("copy").onclick = () => this.copy();
    at("save").onclick = () => this.save();
    at("open").onchange = async () => {
      if (at("open").files[0]) await this.read(at("open").files[0]);
      at("open").value = ""; // the same file may be opened again when it has changed
    };
    at("forget").onclick = () => { this.file = null; at("forget").hidden = true; this.redraw(); };
    const wide = matchMedia("(min-width: 980px)"), beside = () => (at("sliders").open = wide.matches);
    wide.addEventListener("change", beside);
    beside();
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => { event.preventDefault(); if (event.dataTransfer.files[0]) this.read(event.dataTransfer.files[0]); });
    addEventListener("resize", () => this.redraw());
    addEventListener("popstate", () => this.restore());
    addEventListener("pagehide", () => this.keep());
  }

  /** All parameter sets of a model, with the module that runs them; those of opened files come last. */
  sets(model) {
    const shipped = this.known.modules.filter((m) => m.name === model).flatMap((about) => about.sets.map((set) => ({ about, set })));
    return [...shipped, ...this.opened.filter(({ about }) => about.name === model)];
  }

  /** To another joint or set; the browser's way back leads here. */
  async leave(model, index) {
    this.keep();
    history.pushState(null, "", location.hash);
    await this.choose(model, index);
    this.keep();
  }

  /** The address says what is set: the joint, and all that differs from the parameter set as it begins. */
  keep() {
    if (!this.path) return;
    const base = this.set.base ?? this.set, said = new URLSearchParams({ joint: this.about.name, set: base.name }), first = this.start(base);
    for (const name in this.set.fixed) if (this.set.fixed[name] !== this.about.entries[name].value) said.set(name, this.set.fixed[name]);
    for (const [name, value] of this.values) if (value !== first.get(name)) said.set(name, value);
    for (const { v, value, first } of this.others) if (value !== first) said.set(v.name, value);
    if (this.path.inputs.map((v) => v.name).join() !== this.about.path.join()) said.set("path", this.path.inputs.map((v) => v.name).join());
    if (`#${said}` !== location.hash) history.replaceState(null, "", `#${said}`);
  }

  /** What the address says; the first joint if it says nothing. Numbers of a set that is not here belong to no joint, and are left out. */
  async restore() {
    const said = new URLSearchParams(location.hash.slice(1)), model = this.known.modules.find((m) => m.name === said.get("joint"))?.name ?? this.known.modules[0].name;
    const sets = this.sets(model), index = said.has("set") ? sets.findIndex((s) => !s.set.base && s.set.name === said.get("set")) : 0;
    const { about, set } = sets[Math.max(index, 0)], numbers = [...said].filter(([name]) => !["joint", "set", "path"].includes(name));
    const here = index >= 0 && (!said.has("joint") || model === said.get("joint"));
    const fixed = Object.fromEntries(numbers.filter(([name]) => here && about.fixed.includes(name) && name in about.entries).map(([name, text]) => [name, Number(text)]));
    const wrong = Object.entries(fixed).map(([name, value]) => outside(name, value, about.entries[name])).find(Boolean);
    await (Object.keys(fixed).length && !wrong ? this.view({ about, set: { ...set, fixed, base: set } }) : this.choose(model, Math.max(index, 0)));
    if (wrong || !here) return this.say(`The address belongs to another page: ${wrong || `${said.get("joint")}, ${said.get("set")} is not here`}. Shown is ${set.name}.`, true);
    const ways = said.get("path")?.split(",") ?? [];
    if (ways.length && ways.every((name) => name in this.about.pairs)) this.follow(ways);
    for (const [name, text] of numbers) {
      const number = Number(text), other = this.others.find((control) => control.v.name === name);
      if (this.controls[name]) this.values.set(name, text === "true" || (text !== "false" && number));
      else if (other && Number.isFinite(number)) other.moved(number);
    }
    this.shown();
  }

  /** The present values, at the controls and drawn. */
  shown() {
    for (const name in this.controls) this.controls[name].show(this.values.get(name));
    this.redraw();
  }

  /** A control of something that is no variable of the joint. */
  beside(v, value, change) {
    this.others.push(new Control(v, value, change));
    return this.others.at(-1);
  }

  choose(model, index) {
    return this.view(this.sets(model)[index]);
  }

  /** Another joint, { about, set }, in place of the one that was shown. */
  async view({ about, set }) {
    const joint = await (set.running ??= Joint.of(about, set)), sets = this.sets(about.name);
    at("model").value = about.name;
    at("set").replaceChildren(...sets.map((s, i) => element("option", { value: i }, s.set.name)));
    at("set").value = sets.findIndex((s) => s.set === (this.opened.some((o) => o.set === set) ? set : set.base ?? set));
    this.about = about;
    this.set = set;
    this.joint = joint;
    at("doc").textContent = `${set.name}. ${about.doc}. Interface law ${about.law}.`;
    this.said = new Set();
    this.path = null;
    this.others = [];
    const views = ["curves", "path", "map", "body", "turn"].map((id) => at(id));
    views.forEach((view) => view.replaceChildren());
    this.values = this.start(set);
    this.end = about.ramp.end;
    this.controls = controls(at("controls"), about, this.values, (name, value) => { this.values.set(name, value); this.redraw(); });
    this.rampControl(about);
    const bound = about.variables.filter((v) => v.bound).map((v) => v.name);
    at("left-out").textContent = [about.variables.some((v) => v.causality !== "output" && warm(v)) ? "" : "Nothing of this joint depends on temperature, so there is no slider for it.", bound.length ? `No sliders, because the bolt positions or other fixed numbers determine them: ${bound.join(", ")}.` : ""].join(" ");
    this.curves = new Curves(views[0], this.joint);
    at("map-part").hidden = !about.map;
    this.map = about.map && new PressureMap(views[2], this.joint);
    at("example").hidden = !about.example;
    at("turn-part").hidden = !about.turn;
    this.turn = about.turn && new Turn(views[4], this.joint, this);
    this.body = new Body(views[3], this.joint, this);
    this.path = new Path(views[1], this.joint, this, about.path);
    this.sight = new Sight();
    this.draw();
  }

  /** Values of a parameter set; a load that the path does not move begins at a third of its ramp. */
  start(set) {
    const { input, end } = this.about.ramp, values = new Map([...Object.entries(set.values), ...Object.entries(set.inputs)]);
    if (!values.get(input) && !this.about.path.includes(input)) values.set(input, end / 3);
    return values;
  }

  /** A path along other inputs. */
  follow(names) {
    at("path").replaceChildren();
    this.path = new Path(at("path"), this.joint, this, names);
    this.draw();
    at("moved").focus();
  }

  rampControl(about) {
    const v = about.variables.find((each) => each.name === about.ramp.input);
    const ramp = { ...v, name: "ramp to", doc: `end of the ramp of ${v.name}: ${v.doc}`, span: [0.02 * about.ramp.end, 3 * about.ramp.end], log: true };
    const control = this.beside(ramp, this.end, (x) => { if (x > 0) { this.end = x; this.redraw(); } });
    at("ramp").replaceChildren(control.node);
  }

  /** Other values, shown at the controls. */
  take(set) {
    this.values = this.start(set);
    this.shown();
  }

  /** Some other values, shown at the controls. */
  change(values, doc) {
    for (const [name, value] of Object.entries(values)) this.values.set(name, value);
    this.say(`Set: ${doc}.`);
    this.shown();
  }

  /** After a change: what is in sight with the next frame, its ramps coarse; then the rest, and fine ones. */
  redraw() {
    this.asked ??= requestAnimationFrame(() => { this.asked = null; this.draw(true); });
  }

  /** Everything again; only what is `seen` at once, and the rest when there is time, unless it changes before. */
  draw(seen = false) {
    if (!this.joint) return;
    const began = performance.now();
    clearTimeout(this.rest);
    this.joint.messages.clear();
    this.good = this.joint.begin(this.values);
    document.body.classList.toggle("refused", !this.good);
    this.now = this.good && Object.fromEntries(this.about.variables.filter((v) => v.causality !== "parameter").map((v) => [v.name, this.joint.get(v.name)]));
    this.said = new Set(this.joint.messages); // of the sliders and of the path, not of a ramp that begins without load
    const views = this.views(seen ? COARSE : STEPS);
    for (const { place } of views) place.classList.add("stale");
    if (this.good) {
      const near = views.filter(({ place }) => !seen || this.sight.sees(place));
      for (const view of near) this.show(view);
      const done = new Set(near.filter((v) => !seen || !v.ramp).map((v) => v.place));
      const due = () => [...this.views(STEPS).filter(({ place }) => !done.has(place)), ...this.fits()];
      this.rest = setTimeout(() => this.later(due()), PAUSE);
    } else this.rest = setTimeout(() => this.keep(), PAUSE);
    this.tell();
    this.took = performance.now() - began;
  }

  show({ place, show }) {
    show();
    place.classList.remove("stale");
  }

  /** Sliders over what the joint takes with the present values. */
  fits() {
    const sliders = Object.values(this.controls).filter((control) => control.range);
    return sliders.map((control) => ({ place: control.node, show: () => control.fit(allowed(this.joint, this.values, control.full)) }));
  }

  /** { place, show, ramp } of everything that depends on the values; the ramp is gone once for all its curves. */
  views(steps) {
    let gone;
    const found = () => (gone ??= ramp(this.joint, this.values, this.end, steps));
    return [
      ...this.curves.panels.map((panel) => ({ place: panel.chart.figure, show: () => this.curves.draw(panel, this, found()), ramp: true })),
      ...this.path.views(),
      ...(this.turn ? this.turn.views() : []),
      ...(this.map ? [{ place: this.map.figure, show: () => this.map.draw(this.values) }] : []),
      ...this.body.views(steps),
      { place: at("points"), show: () => this.published() },
    ];
  }

  /** Views one after the other, a slice at a time, so that the next change need not wait. */
  later(due) {
    for (const end = performance.now() + SLICE; due.length && performance.now() < end; ) this.show(due.shift());
    this.tell();
    if (!due.length) this.keep();
    else this.rest = setTimeout(() => this.later(due));
  }

  /** Published points beside what the joint gives with the present parameters and the point's own. */
  published() {
    at("points-part").hidden = !this.about.points.length;
    const rest = new Map(this.values);
    for (const name in this.set.inputs) rest.set(name, 0);
    const rows = this.about.points.map((p) => {
      const good = this.joint.begin(new Map([...rest, ...Object.entries(p.at)]));
      const v = this.joint.variables.get(p.output), now = good ? this.joint.get(p.output) : NaN;
      return [p.id, p.place, p.doc, v.name, p.value * v.factor, now * v.factor, unitText(v.shown), `${digits(Number((100 * (now / p.value - 1)).toFixed(6)), 2)} %`];
    });
    at("points").replaceChildren(table("Published points and this joint", ["point", "where", "role", "output", "published", "here", "unit", "difference"], rows));
  }

  /** What the joint said. */
  tell() {
    const lines = new Set([...this.said, ...(this.path && this.good ? this.path.messages : [])]);
    const told = [...lines].slice(0, 4).map((line) => element("p", {}, line)), text = told.map((p) => p.outerHTML).join("");
    if (at("said").innerHTML !== text) at("said").replaceChildren(...told);
    at("said").classList.toggle("error", !this.good);
  }

  say(text, refused = false) {
    at("done").textContent = text;
    at("done").classList.toggle("error", refused);
  }

  toml() {
    return written(this.set, this.about, this.values, this.start(this.set));
  }

  async copy() {
    try {
      await navigator.clipboard.writeText(this.toml());
      this.say("The parameters are on the clipboard.");
    } catch {
      this.say("The browser does not allow access to the clipboard here; save the file instead.");
    }
  }

  save() {
    download(new Blob([this.toml()], { type: "application/toml" }), `${this.about.joint}.toml`);
    this.say("The parameters are saved; jointfmu build --params takes the file.");
  }

  async read(file) {
    try {
      const text = await file.text();
      if (file.name.toLowerCase().endsWith(".toml")) await this.readParameters(text, file.name);
      else {
        this.file = readCsv(text, file.name, this.known.units);
        at("forget").hidden = false;
        this.say(`${file.name}: ${this.file.columns[0].values.length} points, drawn with the curves of the same quantities.`);
        this.redraw();
      }
    } catch (error) {
      this.say(`${file.name}: ${error.message}`, true);
    }
  }

  /** Show the joint of a parameter file; an Error, and nothing changes, if the page does not have it. */
  async readParameters(text, name) {
    const found = placed(text, name, this.known, this.about.name), { about, set } = found, trial = await Joint.of(about, set);
    if (!trial.begin(new Map(Object.entries({ ...set.values, ...set.inputs })))) throw new Error([...trial.messages].join("; "));
    set.running = Joint.of(about, set);
    this.opened = [...this.opened.filter((o) => o.set.name !== set.name || o.about !== about), found];
    await this.leave(about.name, this.sets(about.name).indexOf(found));
    this.say(`${name}: ${set.name} shown.`);
  }
}

const laboratory = (async () => {
  const known = await unpacked(at("content").textContent);
  const lab = new Laboratory(known);
  await lab.restore();
  at("waiting").remove();
  at("bench").hidden = false;
  lab.draw();
  return lab;
})();
laboratory.catch((error) => (at("waiting").textContent = `This browser does not run the page: ${error.message}`));
