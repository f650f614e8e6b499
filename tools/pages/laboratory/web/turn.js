/* A shaft that turns under a constant load on the other one: torque and error over a turn, efficiency over the load. */

const [TURN_STEPS, LOADS, RUN_IN, LONG] = [180, 24, 20, 0.5];

/** What to press where the parameters have no loss. */
const EXAMPLE = "The button \"Example with losses\" sets values that show it.";

class Turn {
  constructor(place, joint, lab) {
    [this.joint, this.lab, this.about] = [joint, lab, joint.about.turn];
    const v = (name) => joint.variables.get(name), { input_angle: driven, speed, torque, load, error } = this.about;
    [this.driven, this.speed, this.torque, this.load, this.error] = [driven, speed, torque, load, error].map(v);
    this.rated = lab.values.get(this.about.rated);
    [this.load_now, this.speed_now] = [this.rated / 2, this.about.default_speed];
    const asked = (key, like, doc, span) => lab.beside({ ...like, name: key.replace("_now", ""), doc, span, log: true }, this[key], (x) => { if (x > 0) { this[key] = x; lab.redraw(); } });
    place.append(element("div", { class: "row" },
      asked("load_now", this.load, "torque at the output that resists the motion", [0.02 * this.rated, 2 * this.rated]).node,
      asked("speed_now", this.speed, this.speed.doc, [this.about.default_speed / 20, 3 * this.about.default_speed]).node));
    const charts = element("div", { class: "charts" });
    place.append(charts);
    this.over = new Chart(charts, `Torque to turn ${driven}`, "");
    this.wave = new Chart(charts, `${error} over a turn`, this.error.doc);
    this.gain = new Chart(charts, "Efficiency over the load", `Load divided by ratio times mean torque on ${driven}, at this speed.`);
  }

  views() {
    return [{ place: this.over.figure, show: () => this.turned() }, { place: this.wave.figure, show: () => this.wavy() }, { place: this.gain.figure, show: () => this.efficient() }];
  }

  /** From rest to a load that resists the motion; false if the joint does not carry it. */
  loaded(load) {
    const { joint, lab, about } = this, values = new Map(lab.values);
    for (const name of [about.input_angle, about.speed, about.follower, about.follower_speed]) values.set(name, 0);
    this.ratio = values.get(about.ratio);
    if (!joint.begin(values)) return false;
    const target = -Math.sign(this.ratio) * load; // the other shaft lags
    this.wound = 0;
    for (let i = 0; i < 60; i++) {
      const missing = target - joint.get(about.load);
      if (Math.abs(missing) < 1e-9 * load) return true;
      this.wound += missing / joint.derivative(about.load, about.follower);
      if (!joint.step({ [about.follower]: this.wound })) return false;
    }
    return true;
  }

  /** On to an angle of the driven shaft; the torque that it takes. */
  to(angle, speed) {
    const { joint, about } = this;
    joint.set(about.input_angle, angle);
    const slope = joint.derivative(about.error, about.input_angle), ahead = joint.get(about.error);
    joint.step({ [about.input_angle]: angle, [about.speed]: speed, [about.follower]: angle / this.ratio + this.wound + ahead - this.start, [about.follower_speed]: speed * (1 / this.ratio + slope) });
    return -joint.get(about.torque);
  }

  /** Angles and torques of a turn after some running in; nothing if the joint does not carry the load. */
  round(load, steps) {
    if (!this.loaded(load)) return [];
    this.start = this.joint.get(this.about.error);
    for (let i = -RUN_IN; i < 0; i++) this.to((LONG * i) / RUN_IN + LONG, this.speed_now);
    return Array.from({ length: steps + 1 }, (_, i) => (2 * Math.PI * i) / steps).map((angle) => [angle, this.to(LONG + angle, this.speed_now), this.joint.get(this.about.error)]);
  }

  turned() {
    const found = this.round(this.load_now, TURN_STEPS), x = found.map(([angle]) => (180 / Math.PI) * angle), y = found.map((p) => p[1] * this.torque.factor);
    const ideal = (this.load_now / Math.abs(this.ratio)) * this.torque.factor, mean = y.slice(1).reduce((sum, one) => sum + one, 0) / Math.max(1, y.length - 1);
    this.found = [x, found.map((p) => p[2])];
    this.over.draw([{ name: "torque", x, y }, { name: "without any loss", x: [0, 360], y: [ideal, ideal], dashed: true, colour: "var(--green)" }], { label: `${this.driven.name} [deg]` }, { label: withUnit("torque", this.torque.shown) });
    this.over.note.textContent = found.length ? `Mean torque ${digits(mean)} ${unitText(this.torque.shown)}, efficiency ${digits((100 * ideal) / mean, 3)} %.` : "The joint does not carry this load.";
  }

  wavy() {
    if (!this.found) this.turned();
    const [x, error] = this.found;
    this.found = null;
    this.wave.note.textContent = error.every((e) => e === 0) ? `The parameters state no kinematic error. ${EXAMPLE}` : this.error.doc;
    this.wave.draw([{ name: this.error.name, x, y: shown(this.error, error) }], { label: `${this.driven.name} [deg]` }, { label: label(this.error) });
  }

  efficient() {
    const loads = Array.from({ length: LOADS }, (_, i) => 2 * this.rated * ((i + 1) / LOADS) ** 2), rows = [];
    for (const load of loads) {
      const torques = this.round(load, LOADS).slice(1).map((p) => p[1]);
      if (!torques.length) break;
      rows.push([load * this.load.factor, (100 * load * torques.length) / (Math.abs(this.ratio) * torques.reduce((sum, t) => sum + t, 0))]);
    }
    const lossless = rows.every((r) => r[1] > 99.99);
    this.gain.note.textContent = lossless ? `The parameters state no friction, so the efficiency is 100 %; that of a real drive is lower. ${EXAMPLE}` : `Load divided by ratio times mean torque on ${this.driven.name}, at this speed.`;
    this.gain.draw([{ name: "efficiency", x: rows.map((r) => r[0]), y: rows.map((r) => r[1]) }], { label: withUnit("load", this.load.shown) }, { label: "efficiency [%]", range: [0, 105] });
  }
}
