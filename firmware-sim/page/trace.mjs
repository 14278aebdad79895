// Prints the hash of a scenario's trace, run by the module of the page in Node: node trace.mjs MODULE MECHANISM MODEL SEED
import { readFileSync } from "node:fs";

const [module, mechanism, model, seed] = process.argv.slice(2);
const imports = { page: { now: () => performance.now() } };
const { instance } = await WebAssembly.instantiate(readFileSync(module), imports);
const { memory, buffer, begin, tick, length, hash, success, text, text_length } = instance.exports;
const file = readFileSync(model);
new Uint8Array(memory.buffer, buffer(), file.length).set(file);
if (!begin(Number(mechanism), file.length, Number(seed))) {
    console.error(Buffer.from(memory.buffer, text(), text_length()).toString());
    process.exit(1);
}
const start = performance.now();
tick(length());
const spent = (performance.now() - start) / length();
console.log(JSON.stringify({
    trace_hash: BigInt.asUintN(64, hash()).toString(16).padStart(16, "0"),
    success: Boolean(success()),
    ticks: length(),
    milliseconds_per_tick: Number(spent.toFixed(3)),
}));
