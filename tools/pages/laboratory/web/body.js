/* A body on the joint: its resonance over the load, and how it rings. */

const [PER_PERIOD, PERIODS] = [40, 14];
/** Damping ratio below which a vibration counts as undamped. */
const MIN_DAMPING = 1e-5;

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
    const controls = [lab.beside(body, this.inertia, (x) => { if (x > 0) { this.inertia = x; lab.redraw(); } })];
    const half = this.input.span[1];
    if (this.moves) controls.push(lab.beside({ name: "pull", doc: `initial deflection of ${this.input.name}, relative to the value of its slider`, unit: this.input.unit, shown: this.input.shown, factor: this.input.factor, span: [0.002 * half, half], log: true }, (this.pull = this.pulled * half), (x) => { this.pull = x; lab.redraw(); }));
    place.append(element("div", { class: "row bodies" }, ...controls.map((c) => c.node)));
    const charts = element("div", { class: "charts" });
    place.append(charts);
    this.over = new Chart(charts, "Resonance over the load", `Square root of |d${this.output.name}/d${this.input.name}|${this.moves ? "" : " (its inverse)"} over the ${this.turns ? "inertia" : "mass"}, along the load ramp.`);
    this.decay = this.moves && new Chart(charts, "Free vibration", "");
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
      this.decay.note.textContent = "At the slider values the joint has no stiffness; the body does not vibrate.";
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
  if (up.length < 2 || peaks.length < 3) return "The body does not vibrate.";
  const hertz = (1e3 * (up.length - 1)) / (up.at(-1) - up[0]);
  const ratio = Math.log(peaks[0] / peaks.at(-1)) / (2 * Math.PI * (peaks.length - 1));
  if (Math.abs(ratio) < MIN_DAMPING) return `Frequency ${digits(hertz)} Hz. The vibration does not decay: the joint has no damping at the slider values.`;
  return `Frequency ${digits(hertz)} Hz, damping ratio ${digits(100 * ratio, 3)} % over the cycles shown.`;
}
