// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// A phone sends photographs through the capture page, and a watcher's open page shows them. Usage: live_test.cjs BUILD [SCREENSHOTS]
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { BUILD, folder, psfm, serve, serve_at, accessible, check, run } = require("./browser.cjs");

const IMAGES = 8, FIRST = 5; // so many make a model

run(async (chrome) => {
  execFileSync(path.join(BUILD, "tests/synthetic/psfm-render-scene"), [path.join(folder, "wall"), "--scene", "wall", "--images", String(IMAGES + 2), "--width", "480", "--height", "360"]);
  const photographs = fs.readdirSync(path.join(folder, "wall/images")).sort().map((name) => path.join(folder, "wall/images", name));
  const more = photographs.splice(IMAGES, 2); // for later
  const session = path.join(folder, "session");
  const link = (name, role) => /#token=\S+/.exec(psfm("serve", "--session", session, "--add-user", name, "--role", role))[0];
  const sender = link("<b>Ada</b>", "send"), looker = link("Look", "look");
  const known = () => new Promise((resolve) => setTimeout(resolve, 1500)); // the server looks at its users every second
  let server = await serve("serve", session, "--keep-free", "1");
  try {
    const problems = [];
    const watcher = await (await chrome.newContext({ viewport: { width: 1280, height: 800 } })).newPage();
    watcher.on("pageerror", (error) => problems.push(String(error)));
    await watcher.goto(`${server.url}/${looker}`);
    await watcher.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    check(!(await watcher.url()).includes("token"), "the token has left the address");
    check(await watcher.evaluate(() => document.cookie) === "", "no script can read the cookie");

    const phone = await (await chrome.newContext({ viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true })).newPage();
    phone.on("pageerror", (error) => problems.push(String(error)));
    await phone.goto(`${server.url}/capture${sender}`);
    await phone.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    const placed = (number) => phone.waitForFunction((n) => document.querySelectorAll(".sent li.placed").length === n, number, { polling: 200, timeout: 300000 });
    await phone.setInputFiles("#choose", photographs.slice(0, FIRST));
    await placed(FIRST); // so that a version of them is kept
    await phone.setInputFiles("#choose", [...photographs.slice(FIRST), path.join(BUILD, "CMakeCache.txt")]);
    await placed(IMAGES);
    check(true, "every photograph is placed, and the phone says so");
    check(await phone.locator(".sent li.refused").count() === 1, "what is no photograph is refused, and the phone says so");
    check((await phone.locator(".summary").textContent()).startsWith(`${IMAGES} photographs: ${IMAGES} placed`), "which is not counted");
    const serious = await accessible(phone, "#app");
    check(serious.length === 0, `axe finds nothing serious on the capture page ${serious.join("; ")}`);
    if (process.argv[3]) await phone.screenshot({ path: path.join(process.argv[3], "capture.png") });

    await watcher.waitForFunction((n) => window.psfm.stage.shownPoses().length === n, IMAGES, { polling: 200, timeout: 60000 });
    check(await watcher.locator(".row.placed").count() > 0, "the watcher's list has them, without a reload");
    check((await watcher.locator(".row .name").first().textContent()).includes(path.basename(photographs[0])), "by the names that they had on the phone");
    const equal = await watcher.evaluate(async () => {
      const { Model } = window.psfm.model.constructor ? { Model: window.psfm.model.constructor } : {};
      const fresh = new Model();
      fresh.apply(await window.psfm.source.scene());
      const sum = (model) => [...model.clusters.values()].map((c) => [c.id, c.count, c.poses.size]).sort().join(";");
      return sum(fresh) === sum(window.psfm.model);
    });
    check(equal, "changes one by one make the same as the snapshot");
    const unlike = await watcher.evaluate(() => {
      const { stage } = window.psfm, gl = stage.renderer.getContext(), size = [gl.drawingBufferWidth, gl.drawingBufferHeight];
      const seen = () => {
        Object.assign(stage.detail, { share: 1, moved: 0, changed: 0 });
        stage.frame();
        const pixels = new Uint8Array(4 * size[0] * size[1]);
        gl.readPixels(0, 0, ...size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels;
      };
      const paint = (cluster, colours) => {
        const last = Uint32Array.from({ length: cluster.slots >> 2 }, (_, i) => cluster.slots - (cluster.slots >> 2) + i);
        cluster.colours.set(colours.subarray(3 * last[0], 3 * cluster.slots), 3 * last[0]);
        cluster.changed.push(last);
        stage.refresh();
      };
      const cluster = [...window.psfm.model.clusters.values()][0], colours = cluster.colours.slice();
      seen();
      paint(cluster, colours.slice().fill(255)); // a change that fits into the buffers
      const bit_by_bit = seen();
      stage.rebuild();
      const differing = seen().filter((value, i) => value !== bit_by_bit[i]).length;
      paint(cluster, colours);
      return differing;
    });
    check(unlike === 0, "points that were uploaded change by change look like all of them anew");
    const few = await watcher.evaluate(async () => {
      const { stage } = window.psfm;
      stage.detail.share = 0.02; // as where drawing is slow
      stage.follow();
      await new Promise((ended) => requestAnimationFrame(() => requestAnimationFrame(ended)));
      return stage.drawn;
    });
    await watcher.waitForFunction((n) => window.psfm.stage.drawn > n && window.psfm.stage.drawn === window.psfm.stage.points(), few, { polling: 100, timeout: 10000 });
    check(true, `after ${few} points all are drawn`);
    await watcher.locator(".row").first().click();
    await watcher.waitForFunction(() => document.querySelector(".picture img")?.naturalWidth > 0, null, { polling: 200, timeout: 30000 });
    check(true, "a photograph is shown with its features");

    await watcher.waitForFunction(() => window.psfm.stage.frusta.hung.length > 0, null, { polling: 200, timeout: 30000 });
    check(true, "cameras hold their photographs");
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "pictures.png") });
    await watcher.getByLabel("pictures").focus();
    await watcher.keyboard.press("Space");
    await watcher.waitForFunction(() => window.psfm.stage.frusta.hung.length === 0, null, { polling: 200, timeout: 30000 });
    check(true, "and hold none when one does not want it");
    await watcher.getByRole("region", { name: "Photographs that it matches" }).getByRole("button").first().press("Enter");
    await watcher.waitForFunction(() => document.querySelectorAll(".picture").length === 2, null, { polling: 100, timeout: 30000 });
    check(true, "a photograph's details open it with another that it matches");
    const tab = watcher.getByRole("tab", { name: "Photographs" });
    await tab.click();
    await watcher.locator(".row").nth(2).click();
    await tab.click();
    await watcher.locator(".row").nth(3).click({ modifiers: ["Shift"] });
    await watcher.waitForFunction(() => window.psfm.selected.join() === "2,3" && document.querySelectorAll(".picture").length === 2, null, { polling: 100, timeout: 30000 });
    check(true, "so does Shift and a click at a second row");
    await tab.click();
    await watcher.getByRole("listbox").press("ArrowDown");
    check(await watcher.evaluate(() => window.psfm.selected.join()) === "3" && await watcher.getByRole("listbox").isVisible(), "arrow keys go through the list and stay there");
    await watcher.getByRole("listbox").press("Enter");
    check(await watcher.locator("#panel-details").isVisible(), "Enter opens");
    check(await watcher.getByRole("link", { name: "Send photographs" }).count() === 0, "who may only look is not sent to the page for phones");

    // Over a camera its photograph is shown; with Ctrl on another one the matches of the two.
    await watcher.evaluate(() => window.psfm.stage.fit());
    const placeOf = (image) => watcher.evaluate((i) => window.psfm.stage.screenOf(i), image);
    const first = await placeOf(0);
    const canvas = watcher.locator("canvas.stage");
    await canvas.hover({ position: first });
    await watcher.waitForFunction(() => document.querySelector(".tip img")?.naturalWidth > 0, null, { polling: 100, timeout: 30000 });
    check((await watcher.locator(".tip").textContent()).includes(".jpg"), "a camera that one is over shows its photograph");
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "hover.png") });
    await canvas.click({ position: first });
    await watcher.waitForFunction(() => document.querySelector("#panel-details h2")?.textContent.endsWith(".jpg"), null, { polling: 100 });
    const second = await placeOf(1).then(async () => { await watcher.evaluate(() => window.psfm.stage.fit()); return placeOf(1); });
    await canvas.click({ position: second, modifiers: ["Control"] });
    await watcher.waitForFunction(() => / matches fit one geometry/.test(document.querySelector("#panel-details")?.textContent ?? ""), null, { polling: 100, timeout: 30000 });
    check(await watcher.locator(".picture").count() === 2, "two photographs are shown with their matches");
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "matches.png") });

    // What events do not tell comes once nothing else does: cameras, pairs, which way is up.
    await watcher.waitForFunction(() => window.psfm.session.edges.length > 0 && window.psfm.session.cameras.length > 0, null, { polling: 200, timeout: 30000 });
    check(true, "pairs and cameras have come without a reload");
    const cluster_without_points = (is_there) => watcher.evaluate((there) => {
      const { model, stage } = window.psfm, { constructor } = model.clusters.values().next().value;
      if (there) model.clusters.set(999, new constructor(999)); else model.clusters.delete(999);
      stage.refresh();
    }, is_there);
    await cluster_without_points(true); // stops no replay
    await watcher.evaluate(() => window.psfm.timeline.go(0));
    await cluster_without_points(false);
    const early = await watcher.evaluate(() => window.psfm.stage.shownPoses().length);
    check(early < IMAGES, `an earlier version had ${early} cameras`);
    await watcher.getByRole("button", { name: "Now" }).click();
    check(await watcher.evaluate(() => window.psfm.stage.shownPoses().length) === IMAGES, "now is now again");
    const lookers = await accessible(watcher, ".side");
    check(lookers.length === 0, `axe finds nothing serious on the viewer ${lookers.join("; ")}`);
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "live.png") });
    const last = await watcher.evaluate(async () => {
      await window.psfm.timeline.go(1e9);
      const then = window.psfm.stage.shownPoses();
      window.psfm.timeline.now();
      const now = new Map(window.psfm.stage.shownPoses().map((pose) => [pose.image, pose]));
      return Math.max(...then.map((pose) => 1 - Math.abs(pose.q.reduce((sum, v, i) => sum + v * now.get(pose.image).q[i], 0))));
    });
    check(last < 1e-3, `the replay's last cameras look where those of now do (${last})`);

    // The server goes, and comes back.
    const port = Number(new URL(server.url).port);
    await server.end();
    const notice = (page, words) => page.waitForFunction((w) => document.querySelector(".notice")?.textContent.includes(w), words, { polling: 100, timeout: 30000 });
    await notice(watcher, "the server does not answer; trying again");
    await watcher.getByRole("tab", { name: "Photographs" }).click();
    await watcher.locator(".row").nth(1).click();
    await watcher.waitForFunction(() => document.querySelector("#panel-details .notice")?.textContent.includes("the server does not answer"), null, { polling: 100, timeout: 10000 });
    check(true, "that the server has gone is said, and why nothing is shown");
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "gone.png") });
    server = await serve_at(port, "serve", session, "--keep-free", "1");
    await watcher.waitForFunction(() => document.querySelector(".side > .notice").textContent === "", null, { polling: 100, timeout: 30000 });
    check(true, "and no longer when it is back");

    psfm("serve", "--session", session, "--remove-user", "Look");
    await server.end(); // and its stream of events
    server = await serve_at(port, "serve", session, "--keep-free", "1");
    await notice(watcher, "this link has been taken back or has run out");
    check(true, "a watcher whose link was taken back is told");

    // A link is taken back: what is chosen then is kept until there is another.
    await phone.reload();
    await phone.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    check(await phone.locator(".sent li.refused").count() === 1, "what was refused is listed after a reload");
    await phone.getByRole("button", { name: /^Dismiss/ }).click();
    await phone.waitForFunction(() => document.querySelectorAll(".sent li.refused").length === 0, null, { polling: 100 });
    phone.once("dialog", (dialog) => dialog.accept());
    const sent = await phone.locator(".sent li").count();
    await phone.getByRole("button", { name: /^Delete/ }).first().click();
    await phone.waitForFunction((n) => document.querySelectorAll(".sent li").length === n, sent - 1, { polling: 100, timeout: 30000 });
    psfm("serve", "--session", session, "--remove-user", "<b>Ada</b>");
    await known();
    await phone.setInputFiles("#choose", more);
    await notice(phone, "this link has been taken back or has run out; your 2 photographs are kept here: open a new link");
    if (process.argv[3]) await phone.screenshot({ path: path.join(process.argv[3], "taken_back.png") });
    const kept = await accessible(phone, "#app");
    check(kept.length === 0, `axe finds nothing serious there ${kept.join("; ")}`);
    await phone.reload();
    await notice(phone, "it has run out or has been taken back: ask for a new one; your 2 photographs are kept here");
    await phone.goto(`${server.url}/capture${sender}`);
    await notice(phone, "this link has run out or has been taken back, or was never one");
    check(true, "a link that was taken back keeps what was chosen, and says so");
    const beside = await phone.context().newPage();
    const again = link("Ada again", "send");
    await known();
    await beside.goto(`${server.url}/${again}`);
    await phone.waitForFunction(() => document.querySelector(".summary").textContent.includes("0 to be sent"), null, { polling: 100, timeout: 60000 });
    await phone.waitForFunction(() => document.querySelector(".notice").hidden, null, { polling: 100, timeout: 60000 });
    check(await phone.locator(".sent li").count() === 2, "a new link, opened beside it, sends them");

    // The viewer on a phone.
    await beside.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    await beside.setViewportSize({ width: 390, height: 844 });
    await beside.waitForTimeout(500);
    const bars = await beside.evaluate(() => {
      const { stage } = window.psfm, [top, bottom] = stage.bars(), height = stage.canvas.clientHeight;
      stage.fit();
      const ys = stage.shownPoses().map((pose) => stage.screenOf(pose.image).y);
      return { top, bottom, height, low: Math.min(...ys), high: Math.max(...ys) };
    });
    check(bars.top + bars.bottom < 0.35 * bars.height && bars.low >= bars.top && bars.high <= bars.height - bars.bottom, `the model is between the bars ${JSON.stringify(bars)}`);
    if (process.argv[3]) await beside.screenshot({ path: path.join(process.argv[3], "phone.png") });
    await beside.getByRole("link", { name: "Send photographs" }).click();
    await beside.waitForURL(/capture$/);
    check(true, "who may send gets to the page for phones");

    const viewing = await serve("view", session);
    await beside.goto(`${viewing.url}/capture`);
    await notice(beside, "this server takes no photographs");
    check(true, "a server that only shows says so on the page for phones");
    const shown = await (await chrome.newContext()).newPage();
    // A photograph that was taken back has no thumbnail.
    const isOdd = (message) => message.type() === "error" && !message.location().url.endsWith("/thumbnail");
    shown.on("console", (message) => { if (isOdd(message)) problems.push(`${message.text()} ${message.location().url}`); });
    await shown.goto(viewing.url);
    await shown.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    await shown.waitForTimeout(500);
    check(await shown.getByRole("link", { name: "Send photographs" }).count() === 0, "and its viewer does not lead there");
    await shown.close();
    await viewing.end();
    check(problems.length === 0, `no errors ${problems.join("; ")}`);
  } finally {
    await server.end();
  }
}).catch((error) => { console.error(error); process.exit(1); });
