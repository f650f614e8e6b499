/* The content of the page, and a joint: one instance of a module of the native FMU's C. */

/** The JSON text and the modules out of the packed content. */
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const all = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(all.buffer).getUint32(0, true);
  const known = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length)));
  let at = 4 + length;
  for (const module of known.modules) {
    module.binary = all.slice(at, at + module.size);
    at += module.size;
  }
  return known;
}

class Joint {
  /** set: the parameter set whose numbers that no slider moves stand in the module's data. */
  constructor(about, c, set) {
    c._initialize();
    const fixed = new Float64Array(c.memory.buffer, c.lab_hidden_parameters(), about.fixed.length);
    about.fixed.forEach((name, i) => (fixed[i] = set.fixed[name] ?? fixed[i]));
    this.about = about;
    this.c = c;
    this.instance = c.lab_create();
    this.variables = new Map(about.variables.map((v, i) => [v.name, { ...v, reference: i + 1 }]));
    this.messages = new Set();
    this.starts = 0;
  }

  static async of(about, set = about.sets[0]) {
    about.compiled ??= WebAssembly.compile(about.binary);
    return new Joint(about, (await WebAssembly.instantiate(await about.compiled)).exports, set);
  }

  get(name) {
    return this.c.lab_get(this.instance, this.variables.get(name).reference);
  }

  /** Whether a value is taken; it is checked when the joint begins or goes on. */
  set(name, value) {
    return this.c.lab_set(this.instance, this.variables.get(name).reference, Number(value)) === 0;
  }

  /** At rest with these values of parameters and inputs (a Map); false if they are refused. */
  begin(values) {
    this.starts++;
    this.c.lab_reset(this.instance);
    const taken = [...values].map(([name, value]) => this.set(name, value)).every(Boolean);
    return this.told(this.c.lab_initialize(this.instance)) && taken;
  }

  /** On to other inputs, { name: value }; false if they are refused. */
  step(inputs) {
    for (const name in inputs) this.set(name, inputs[name]);
    return this.told(this.c.lab_step(this.instance, 1));
  }

  derivative(output, input) {
    const [of, by] = [output, input].map((name) => this.variables.get(name).reference);
    return this.c.lab_derivative(this.instance, of, by);
  }

  /** Rows of x, y, share and value over the contact; none if this joint has no map. */
  map() {
    const at = this.c.lab_map ? this.c.lab_map(this.instance) : 0;
    if (!at) return [];
    const all = new Float64Array(this.c.memory.buffer, at, 4 * this.c.lab_map_size());
    return Array.from({ length: all.length / 4 }, (_, i) => Array.from(all.subarray(4 * i, 4 * i + 4)));
  }

  /** A refusal or a warning in the units of the sliders: value and interval, which C states in SI. */
  asShown(line) {
    const v = this.variables.get(line.match(/^(\S+) = /)?.[1]);
    if (!v || v.factor === 1) return line;
    const own = (text) => (Number.isFinite(Number(text)) ? Number((text * v.factor).toPrecision(6)) : text), unit = unitText(v.shown);
    return line
      .replace(/^(\S+ = )([^\s:]+)(?: [^\s:]+)?(?=:| is outside)/, (_, name, value) => `${name}${own(value)} ${unit}`)
      .replace(/ is outside ([[(])(\S+), ([^\])]+)([\])])(?: [^\s:]+)?:/, (_, left, low, high, right) => ` is outside ${left}${own(low)}, ${own(high)}${right} ${unit}:`);
  }

  /** Whether a call went well; what the joint said goes to `messages`. */
  told(status) {
    const bytes = new Uint8Array(this.c.memory.buffer, this.c.lab_take_messages());
    const text = bytes[0] ? new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))) : "";
    for (const line of text.split("\n")) if (line) this.messages.add(this.asShown(line.slice(1)));
    return status === 0;
  }
}
