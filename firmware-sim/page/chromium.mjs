// A page in Chromium, driven over a pipe so that no package is needed: const page = await open(CHROMIUM); … await page.close().
import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";

export const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));
export const check = (holds, what) => { if (!holds) throw new Error(what); };

/** Starts the browser with an empty page. `failures` collects errors of the page's scripts. */
export async function open(program) {
    const profile = mkdtempSync(join(tmpdir(), "page-"));
    const browser = spawn(program, ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe", `--user-data-dir=${profile}`],
        { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    const wanted = new Map();
    let count = 0, rest = "", session;
    const failures = [];
    browser.stdio[4].on("data", data => {
        const messages = (rest + data).split("\0");
        rest = messages.pop();
        for (const { id, result, error, method, params } of messages.map(JSON.parse)) {
            if (method === "Runtime.exceptionThrown") failures.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
            if (method === "Runtime.consoleAPICalled" && params.type === "error") failures.push(JSON.stringify(params.args));
            if (!wanted.has(id)) continue;
            const [done, failed] = wanted.get(id);
            wanted.delete(id);
            error ? failed(new Error(error.message)) : done(result);
        }
    });
    const send = (method, params = {}) => new Promise((done, failed) => {
        wanted.set(++count, [done, failed]);
        browser.stdio[3].write(JSON.stringify({ id: count, sessionId: session, method, params }) + "\0");
    });
    const value = async expression => {
        const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    };
    const until = async (expression, seconds, what) => {
        for (const end = Date.now() + 1000 * seconds; Date.now() < end; await pause(50)) if (await value(expression)) return;
        throw new Error(`${what}: not within ${seconds} s`);
    };
    const picture = async file => {
        mkdirSync(dirname(file), { recursive: true });
        const { data } = await send("Page.captureScreenshot", { captureBeyondViewport: true });
        writeFileSync(file, Buffer.from(data, "base64"));
    };
    const mouse = (type, [x, y]) => send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
    const close = async () => {
        browser.kill();
        await new Promise(done => browser.on("exit", done));
        rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
    };
    const { targetId } = await send("Target.createTarget", { url: "about:blank" });
    ({ sessionId: session } = await send("Target.attachToTarget", { targetId, flatten: true }));
    await Promise.all(["Page.enable", "Runtime.enable"].map(method => send(method)));
    return { failures, send, value, until, picture, mouse, close };
}
