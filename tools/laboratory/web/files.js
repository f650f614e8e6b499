/* Parameter files out of the page and into it, and measured curves from CSV files. */

const tomlNumber = (x) => (typeof x === "boolean" ? String(x) : Number.isInteger(x) && Math.abs(x) < 1e15 ? `${x}.0` : String(x));
const ENTRY = /^(\w+)(\s*=\s*\{\s*value\s*=\s*)([^,}\[]+?)(\s*[,}].*)$/;

/** The text of a parameter set with other values; units stay, changed entries come from the user. */
function written(set, about, values) {
  const units = new Map(about.variables.map((v) => [v.name, v.unit]));
  const entry = (leaf, name) => `${leaf} = { value = ${tomlNumber(values.get(name))}, ${typeof values.get(name) === "boolean" ? "" : `unit = "${units.get(name)}", `}kind = "user", source = "set in the laboratory" }`;
  const lines = [];
  let section = "";
  for (const line of set.toml.split("\n")) {
    const head = line.match(/^\[(.+)\]$/);
    if (head) section = head[1];
    if (section === "inputs") continue;
    const [, leaf] = line.match(ENTRY) || [];
    const name = section ? `${section}.${leaf}` : leaf;
    lines.push(leaf && name in set.values && values.get(name) !== set.values[name] ? entry(leaf, name) : line);
  }
  while (lines.at(-1) === "") lines.pop();
  const inputs = Object.keys(set.inputs).filter((name) => values.get(name) !== 0);
  if (inputs.length) lines.push("", "[inputs]", ...inputs.map((name) => entry(name, name)));
  return lines.join("\n") + "\n";
}

/** { joint, law, values } of a parameter file as the package writes it; an Error if it is none. */
function readToml(text) {
  const found = { values: new Map() };
  let section = "";
  for (const line of text.split(/\r?\n/)) {
    const head = line.match(/^\s*\[([\w.]+)\]\s*(#.*)?$/);
    if (head) section = head[1];
    const top = line.match(/^\s*(joint|law|name)\s*=\s*"([^"]*)"/);
    if (top && !section) found[top[1]] = top[2];
    const entry = line.trim().match(ENTRY);
    if (!entry) continue;
    const raw = entry[3].trim(), number = Number(raw.replaceAll("_", ""));
    const value = raw === "true" ? true : raw === "false" ? false : raw.startsWith('"') ? raw.slice(1, -1) : number;
    if (Number.isNaN(value)) throw new Error(`${entry[1]} = ${raw} is no number`);
    found.values.set(section && section !== "inputs" ? `${section}.${entry[1]}` : entry[1], value);
  }
  if (!found.joint) throw new Error('no line joint = "..."; expected a parameter file');
  return found;
}

/** What of a file the page cannot show: values that are baked into the module and are others there. */
function bakedOtherwise(file, set) {
  const own = readToml(set.toml).values;
  return [...file.values].filter(([name, value]) => !(name in set.values) && !(name in set.inputs) && !name.startsWith("roughness.") && own.get(name) !== value).map(([name]) => name);
}

/** { name, columns: [{ name, base, values }] } of a CSV file with a line of `name [unit]`; an Error if it is none. */
function readCsv(text, name, units) {
  const rows = text.split(/\r?\n/).filter((line) => line.trim() && !line.trim().startsWith("#"));
  const sign = rows.length && [";", "\t", ","].find((s) => rows[0].includes(s));
  if (!sign) throw new Error("no columns; expected a line such as angle [arcmin], torque [N.m]");
  const cells = (line) => line.split(sign).map((cell) => cell.trim());
  const columns = cells(rows[0]).map((head) => {
    const unit = head.match(/\[(.+)\]/)?.[1].replaceAll(/[ *·]/g, ".").replace(/^(k|m)?Nm$/, "$1N.m") ?? "";
    const base = Object.keys(units).find((base) => unit in units[base]);
    return base && { name: head, base, size: units[base][unit], values: [] };
  });
  const used = columns.filter((c) => c && !/^run\b/.test(c.name));
  if (!["rad", "m"].some((b) => used.some((c) => c.base === b)) || !["N.m", "N"].some((b) => used.some((c) => c.base === b)))
    throw new Error(`columns ${cells(rows[0]).join(", ")}; expected one in ${Object.keys(units.rad).join(", ")} or ${Object.keys(units.m).join(", ")} and one in ${Object.keys(units["N.m"]).join(", ")} or ${Object.keys(units.N).join(", ")}`);
  for (const [i, line] of rows.slice(1).entries()) {
    const row = cells(line);
    columns.forEach((c, k) => {
      if (!c) return;
      const number = Number(sign === ";" ? row[k]?.replace(",", ".") : row[k]);
      if (!row[k] || Number.isNaN(number)) throw new Error(`row ${i + 2}: ${c.name} = ${row[k] || "nothing"} is no number`);
      c.values.push(number * c.size);
    });
  }
  return { name, columns: used };
}
