// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// A phone sends photographs through the capture page, and a watcher's open page shows them. Usage: live_test.cjs BUILD [SCREENSHOTS]
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { BUILD, folder, psfm, serve, accessible, check, run } = require("./browser.cjs");

const IMAGES = 8;

run(async (chrome) => {
  execFileSync(path.join(BUILD, "tests/synthetic/psfm-render-scene"), [path.join(folder, "wall"), "--scene", "wall", "--images", String(IMAGES), "--width", "480", "--height", "360"]);
  const photographs = fs.readdirSync(path.join(folder, "wall/images")).sort().map((name) => path.join(folder, "wall/images", name));
  const session = path.join(folder, "session");
  const link = (name, role) => /#token=\S+/.exec(psfm("serve", "--session", session, "--add-user", name, "--role", role))[0];
  const sender = link("<b>Ada</b>", "send"), looker = link("Look", "look");
  const server = await serve("serve", session, "--keep-free", "1");
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
    await phone.setInputFiles("#choose", [...photographs, path.join(BUILD, "CMakeCache.txt")]);
    await phone.waitForFunction((n) => document.querySelectorAll(".sent li.placed").length === n, IMAGES, { polling: 200, timeout: 300000 });
    check(true, "every photograph is placed, and the phone says so");
    check(await phone.locator(".sent li.refused").count() === 1, "what is no photograph is refused, and the phone says so");
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
    await watcher.locator(".row").first().click();
    await watcher.waitForFunction(() => document.querySelector(".picture img")?.naturalWidth > 0, null, { polling: 200, timeout: 30000 });
    check(true, "a photograph is shown with its features");

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
    await watcher.evaluate(() => window.psfm.timeline.go(2));
    const early = await watcher.evaluate(() => window.psfm.stage.shownPoses().length);
    check(early < IMAGES, `an earlier version had ${early} cameras`);
    await watcher.getByRole("button", { name: "Now" }).click();
    check(await watcher.evaluate(() => window.psfm.stage.shownPoses().length) === IMAGES, "now is now again");
    const lookers = await accessible(watcher, ".side");
    check(lookers.length === 0, `axe finds nothing serious on the viewer ${lookers.join("; ")}`);
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "live.png") });
    check(problems.length === 0, `no errors ${problems.join("; ")}`);
  } finally {
    server.end();
  }
}).catch((error) => { console.error(error); process.exit(1); });
