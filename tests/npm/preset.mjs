/**
 * A plain Node program that has installed the package: it runs presets, and gets the golden digests.
 *
 * `node preset.mjs FOLDER`, the folder being `tests/golden/`; the package is found as Node finds any.
 */
import assert from "node:assert/strict";
import { readFile, readdir } from "node:fs/promises";
import { join } from "node:path";
import init, * as stepscope from "stepscope-wasm";

const { ValidatedScenario, presets, version } = stepscope;

const [golden] = process.argv.slice(2);
assert.ok(golden, "give the folder of the golden cases");

/** The package's own files, as they were installed. */
const installed = (name) => new URL(import.meta.resolve(`stepscope-wasm/${name}`));

const about = JSON.parse(await readFile(installed("package.json"), "utf8"));
for (const field of ["description", "keywords", "license", "main", "repository", "types", "version"]) {
  assert.ok(about[field]?.length > 0 || about[field]?.url, `package.json has no ${field}`);
}
for (const name of [about.main, about.types, "stepscope_wasm_bg.wasm", "README.md", "LICENSE-MIT", "LICENSE-APACHE"]) {
  assert.ok((await readFile(installed(name))).length > 0, `${name} is empty`);
}

await init({ module_or_path: await readFile(installed("stepscope_wasm_bg.wasm")) });
assert.equal(version(), about.version);

// The README names only functions that exist.
const exported = Object.values(stepscope).filter((value) => typeof value === "function");
const methods = exported.flatMap((value) => Object.getOwnPropertyNames(value.prototype ?? {}));
const known = new Set([...Object.keys(stepscope), ...methods, "init"]);
const readme = await readFile(installed("README.md"), "utf8");
for (const [, name] of readme.matchAll(/`(?:await |new |\w+\.)*(\w+)\(/g)) {
  assert.ok(known.has(name), `README.md names ${name}, which does not exist`);
}

/** The digests of all controllers of a scenario's run, a line each. */
function digests(scenario) {
  const validated = new ValidatedScenario(scenario);
  const simulation = validated.run();
  try {
    while (!simulation.advance(100_000).done);
    return simulation.summary().controllers.map(({ digest }) => digest);
  } finally {
    simulation.free();
    validated.free();
  }
}

const scenarios = new Map(presets().map(({ id, scenario }) => [id, scenario]));
const cases = (await readdir(golden)).filter((name) => name.startsWith("preset-"));
let found = 0;
for (const name of cases) {
  const text = async (file) => (await readFile(join(golden, name, file), "utf8")).trim();
  const id = await text("preset");
  assert.ok(scenarios.get(id), `the package has no preset ${id}`);
  assert.deepEqual(digests(scenarios.get(id)), (await text("digest")).split("\n"), id);
  found += 1;
}
assert.ok(found > 20, `${golden} has only ${found} presets of the package`);
console.log(`${found} presets gave their golden digests in Node ${process.version}`);
