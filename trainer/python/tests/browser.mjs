// Opens a page of leastaction.viewer in Chromium, over a pipe so that no package is needed: node browser.mjs CHROMIUM PAGE [PICTURES]
// Checks that the motion plays in real time, pauses, and follows the slider; that dragging turns what moves in space; and that no script
// fails. Prints one JSON line: times, and what is drawn. PICTURES is a folder for pictures.
import { basename, join, resolve } from "node:path";
import { check, open, pause } from "../../../firmware-sim/page/chromium.mjs";

const [program, page, pictures] = process.argv.slice(2);
const { failures, send, value, picture: draw, mouse, close } = await open(program);
const picture = name => pictures && draw(join(pictures, `${basename(page, ".html")}-${name}.png`));
const time = () => value("Number(document.documentElement.dataset.time)");
const drawing = () => value(`document.getElementById("scene")?.innerHTML ?? ""`);

async function run() {
    await send("Emulation.setDeviceMetricsOverride", { width: 780, height: 760, deviceScaleFactor: 1, mobile: false });
    await send("Page.navigate", { url: `file://${resolve(page)}` });
    for (const end = Date.now() + 20000; !(await value("Number(document.documentElement?.dataset.time) > 0")); await pause(50)) check(Date.now() < end, `nothing moves: ${failures}`);

    // The clock of the page against that of the machine.
    const [shown, now] = [await time(), await value("performance.now()")];
    await pause(400);
    const pace = (1000 * (await time() - shown)) / (await value("performance.now()") - now);
    await value(`document.getElementById("play").click()`);
    const paused = await time();
    await pause(150);
    check(await time() === paused, "a pause does not hold");
    await picture("paused");

    const before = await drawing();
    const slid = await value(`(() => { const s = document.getElementById("time"); s.value = 0.5 * s.max; s.dispatchEvent(new Event("input")); return Number(s.value); })()`);
    const after = await drawing();
    check(!before || before !== after, "the drawing does not follow the slider");
    let turned = false;
    if (before) {
        const [x, y] = await value(`(() => { const box = document.getElementById("scene").getBoundingClientRect(); return [box.left + box.width / 2, box.top + box.height / 2]; })()`);
        await mouse("mousePressed", [x, y]);
        await mouse("mouseMoved", [x + 90, y + 60]);
        await mouse("mouseReleased", [x + 90, y + 60]);
        turned = (await drawing()) !== after;
    }
    await picture("turned");
    const parts = await value(`["line", "circle", "rect", "polyline"].map(name => document.querySelectorAll("#scene " + name).length)`);
    const charts = await value(`document.querySelectorAll("#charts svg").length`);
    const broken = await value(`document.body.innerHTML.includes("NaN")`);
    check(!broken, "a place is not a number");
    if (failures.length) throw new Error(failures.join("\n"));
    return { pace, time: await time(), slid, turned, parts, charts };
}

try {
    console.log(JSON.stringify(await run()));
} catch (error) {
    console.error(error.message);
    process.exitCode = 1;
}
await close();
