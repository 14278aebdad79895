// Opens the page in Chromium, over a pipe so that no package is needed: node browser.mjs CHROMIUM PAGE [PICTURES]
// Waits for frames, pushes and drags the machine, lets the page refuse a broken file, verifies every machine, and fails on an error of the
// script. Prints the time of a frame. PICTURES is a folder for pictures at the widths of a phone and a desk.
import { join, resolve } from "node:path";
import { check, open, pause } from "./chromium.mjs";

const [program, page, pictures] = process.argv.slice(2);
const { failures, send, value, until, picture: draw, mouse, close } = await open(program);
const picture = name => pictures && draw(join(pictures, `${name}.png`));
const size = (width, height, dark) => Promise.all([
    send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 500 }),
    send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }] }),
]);
const choose = index => value(`document.querySelectorAll("#machines input")[${index}].click()`);
const give = (bytes, name) => value(`(async () => { await take(new File([new Uint8Array(${JSON.stringify([...bytes])})], ${JSON.stringify(name)})); return $("error").textContent; })()`);

/** Drags the last point of the drawing to the other side. */
async function drag() {
    const [from, to] = await value(`(() => { const s = $("scene"), box = s.getBoundingClientRect(), { to } = lens(s.clientWidth, s.clientHeight);
        const at = p => [box.left + to(p)[0], box.top + to(p)[1]], tip = MACHINES[machine].shape.points(now.q).at(-1);
        return [at(tip), at([0.9 * (tip[0] > 0 ? -1 : 1), 0.2])]; })()`);
    await mouse("mousePressed", from);
    await mouse("mouseMoved", to);
    check(await value("hand !== null"), "the pointer grabs nothing");
    await pause(600);
    await picture("drag");
    await mouse("mouseReleased", to);
    check(await value("hand === null"), "the pointer does not let go");
}

async function run() {
    await size(1280, 1000, false);
    await send("Page.navigate", { url: `file://${resolve(page)}#pendulum` });
    await until("document.documentElement?.dataset.frames > 5", 20, "frames");
    const [frames, time] = await value("[shown, performance.now()]");
    await pause(2000);
    const [later, end] = await value("[shown, performance.now()]");
    const work = await value("(() => { const begin = performance.now(); for (let i = 0; i < 20; i++) { drawScene(now.q); drawForce(); drawEnergy(); } return (performance.now() - begin) / 20; })()");
    check(later - frames > 20, `${later - frames} frames in 2 s`);
    const names = await value("MACHINES.map(({ key }) => key)");
    for (const [index, name] of names.entries()) {
        await choose(index);
        await size(1280, 1000, index % 2 === 1);
        await pause(1200);
        await picture(`${name}-1280`);
        await size(390, 1500, index % 2 === 0);
        await pause(300);
        check(await value("document.documentElement.scrollWidth <= 390"), `${name} is wider than a phone`);
        await picture(`${name}-390`);
        await value("verify()");
        check(await value(`document.documentElement.dataset.verified.startsWith("${name} ") && document.documentElement.dataset.verified.endsWith(" true")`),
            `${name}: ${await value("document.documentElement.dataset.verified")}`);
    }
    await size(1280, 1000, false);
    await picture("verified");
    await drag();
    const before = await value("now.decisions");
    check(before > 20, `only ${before} decisions`);
    check((await give([1, 2, 3, 4], "broken.postcard")).startsWith("broken.postcard cannot be used: "), "a broken file is taken");
    check(await value(`now.decisions >= ${before}`), "a broken file ends the run");
    await picture("broken");
    check((await give(await value("Array.from(bytesOf(DATA.models.pendulum))"), "pendulum.postcard")).includes("coordinate"), "a model of one coordinate is taken for two");
    check((await give(await value("Array.from(bytesOf(DATA.models.acrobot))"), "acrobot.postcard")) === "", "the acrobot's model is refused");
    await until("now.decisions > 10", 5, "decisions by a file");
    await value("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true })), document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }))");
    check(await value("paused"), "the space key does not pause");
    check(failures.length === 0, failures.join("\n"));
    check(!(await value("document.documentElement.dataset.failed ?? ''")), "the page failed");
    console.log(JSON.stringify({
        frame_milliseconds: Number(((end - time) / (later - frames)).toFixed(1)), draw_milliseconds: Number(work.toFixed(2)), verified: names,
    }));
}

let code = 0;
try { await run(); } catch (error) { code = 1; console.error(`the page: ${[error.message, ...failures].join("\n")}`); }
await close();
process.exit(code);
