// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// A phone sends photographs through the capture page, and a watcher's open page shows them. Usage: live_test.cjs BUILD [SCREENSHOTS]
const fs = require("fs");
const path = require("path");
const { execFileSync, spawn } = require("child_process");
const { BUILD, folder, psfm, accessible, check, run } = require("./browser.cjs");

const IMAGES = 8;

function serve(session) {
  return new Promise((resolve, reject) => {
    const process_ = spawn(path.join(BUILD, "psfm"), ["serve", "--session", session, "--listen", "127.0.0.1:0", "--keep-free", "1"]);
    let text = "";
    process_.stdout.on("data", (data) => {
      text += data;
      const found = /http:\/\/127\.0\.0\.1:(\d+)/.exec(text);
      if (found) resolve({ process: process_, url: `http://127.0.0.1:${found[1]}` });
    });
    process_.stderr.on("data", (data) => { text += data; });
    process_.on("exit", (code) => reject(new Error(`psfm serve ended with ${code}: ${text}`)));
  });
}

run(async (chrome) => {
  execFileSync(path.join(BUILD, "tests/synthetic/psfm-render-scene"), [path.join(folder, "wall"), "--scene", "wall", "--images", String(IMAGES), "--width", "480", "--height", "360"]);
  const photographs = fs.readdirSync(path.join(folder, "wall/images")).sort().map((name) => path.join(folder, "wall/images", name));
  const session = path.join(folder, "session");
  const link = (name, role) => /#token=\S+/.exec(psfm("serve", "--session", session, "--add-user", name, "--role", role))[0];
  const sender = link("<b>Ada</b>", "send"), looker = link("Look", "look");
  const server = await serve(session);
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
    if (serious !== null) check(serious.length === 0, `axe finds nothing serious on the capture page ${serious.join("; ")}`);
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
    if (process.argv[3]) await watcher.screenshot({ path: path.join(process.argv[3], "live.png") });
    check(problems.length === 0, `no errors ${problems.join("; ")}`);
  } finally {
    server.process.removeAllListeners("exit");
    server.process.kill("SIGTERM");
  }
}).catch((error) => { console.error(error); process.exit(1); });
