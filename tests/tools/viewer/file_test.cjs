// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// A page in one file, from a file: URL without network. Usage: file_test.cjs BUILD [SCREENSHOTS]
const path = require("path");
const fs = require("fs");
const { folder, psfm, accessible, check, run } = require("./browser.cjs");

const IMAGES = 60;

run(async (chrome) => {
  psfm("simulate", "--scene", "courtyard", "--images", String(IMAGES), "--output", path.join(folder, "scene"));
  const session = path.join(folder, "session");
  psfm("import", "--colmap-database", path.join(folder, "scene/database.db"), "--session", session,
    "--set", "solve.assessment.weak_angle_deg=90"); // so that its models are weak
  const file = path.join(folder, "model.html");
  psfm("view", "--session", session, "--output", file);
  const status = JSON.parse(psfm("status", "--session", session, "--json"));

  const context = await chrome.newContext({ offline: true, viewport: { width: 1280, height: 800 }, bypassCSP: false });
  const page = await context.newPage();
  const problems = [];
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") problems.push(message.text()); });
  page.on("request", (request) => { if (!request.url().startsWith("file:") && !request.url().startsWith("data:") && !request.url().startsWith("blob:")) problems.push(request.url()); });
  await page.goto(`file://${file}`);
  await page.waitForFunction(() => document.documentElement.dataset.state, null, { polling: 100, timeout: 60000 });
  check(await page.evaluate(() => document.documentElement.dataset.state) === "ready", "the page is ready");
  const told = await page.evaluate(() => ({
    points: [...window.psfm.model.clusters.values()].reduce((n, c) => n + c.count, 0),
    cameras: window.psfm.stage.shownPoses().length,
    images: window.psfm.session.image_list.length,
  }));
  check(told.cameras === status.placed, `${told.cameras} cameras are shown, as many as are placed`);
  check(told.images === IMAGES, "every photograph is listed");
  const words = status.weak_models.flatMap((model) => model.words);
  check(words.length > 0 && (await page.locator(".weak li").allTextContents()).join() === words.join(), "models that are weak are told of");
  check(told.points > 500, `${told.points} points are shown`);
  await page.waitForFunction(() => window.psfm.stage.drawn === [...window.psfm.model.clusters.values()].reduce((n, c) => n + c.slots, 0), null, { polling: 100 });
  check(true, "all points are drawn once one stands still");

  // Search, pick, see who sees a point.
  const name = status.image_list[7].name;
  await page.getByRole("searchbox").fill(name);
  check(await page.locator(".row").count() === 1, "a search by name finds one");
  await page.locator(".row").click();
  check((await page.locator("#panel-details h2").first().textContent()) === name, "a photograph that is chosen is told of");
  check((await page.locator("#panel-details").textContent()).includes("Pictures are not in this file") && await page.locator(".picture").count() === 0, "that pictures are not in the file is said");
  await page.getByRole("region", { name: "Photographs that it matches" }).getByRole("button").first().click();
  check(/ matches fit one geometry/.test(await page.locator("#panel-details").textContent()) && await page.evaluate(() => window.psfm.selected.length) === 2,
    "a photograph that another matches opens the two");
  const picked = await page.evaluate(async () => {
    const { stage, model } = window.psfm;
    stage.fit();
    await new Promise((resolve) => setTimeout(resolve, 500));
    stage.setLayers(false, false); // no camera is picked instead
    const w = stage.canvas.clientWidth, h = stage.canvas.clientHeight;
    for (let r = 0; r < 300; r += 5) for (const [dx, dy] of [[r, 0], [-r, 0], [0, r], [0, -r]]) {
      const found = stage.pickPoint(w / 2 + dx, h / 2 + dy);
      if (found) return { x: w / 2 + dx, y: h / 2 + dy, track: model.clusters.get(found.cluster).tracks[found.slot] };
    }
    return null;
  });
  check(picked !== null, "a point is found under a pixel");
  await page.locator("canvas.stage").click({ position: { x: picked.x, y: picked.y } });
  await page.waitForFunction(() => document.querySelector("#panel-details h2")?.textContent === "Point", null, { polling: 100 });
  check(await page.locator("#panel-details li").count() === picked.track, "as many photographs see it as its track is long");

  await page.evaluate(() => { window.psfm.stage.setLayers(true, false); });

  // Replay.
  await page.getByRole("slider").focus();
  await page.evaluate(() => window.psfm.timeline.go(Math.floor(20)));
  const early = await page.evaluate(() => ({ cameras: window.psfm.stage.shownPoses().length, time: window.psfm.stage.time }));
  check(early.cameras < status.placed && early.time <= IMAGES, `after ${early.time} photographs ${early.cameras} were placed`);
  if (process.argv[3]) await page.screenshot({ path: path.join(process.argv[3], "replay.png") });
  const wrong = await page.evaluate(() => {
    const { stage, model } = window.psfm, placed = new Set(stage.shownPoses().map((pose) => pose.image));
    let wrong = 0, shown = 0;
    for (const cluster of model.clusters.values()) {
      for (let i = 0; i < cluster.slots; ++i) {
        if (!stage.clouds.get(cluster.id).shows(i, stage.time)) continue;
        ++shown;
        if (!placed.has(cluster.firsts[i]) || !placed.has(cluster.born[i] - 1)) ++wrong;
      }
    }
    return { wrong, shown };
  });
  check(wrong.shown > 0 && wrong.wrong <= 0.02 * wrong.shown, `${wrong.shown} points are shown then, of photographs that stood then, but for ${wrong.wrong}`);
  await page.evaluate(() => window.psfm.timeline.go(0));
  const none = await page.evaluate(() => ({ cameras: window.psfm.stage.shownPoses().length, points: window.psfm.stage.sample(1e9, null).length }));
  check(none.cameras > 0 || none.points === 0, "without a camera there is no point");
  const last = await page.evaluate(async () => {
    const { stage, timeline } = window.psfm;
    await timeline.go(1e9);
    const then = stage.shownPoses(), points = stage.sample(1e9, null).length;
    stage.setReplay(null, null);
    const now = new Map(stage.shownPoses().map((pose) => [pose.image, pose]));
    const extent = Math.max(...[0, 1, 2].map((axis) => Math.max(...then.map((p) => p.centre[axis])) - Math.min(...then.map((p) => p.centre[axis]))));
    let place = 0, turn = 0;
    for (const pose of then) {
      const other = now.get(pose.image);
      place = Math.max(place, Math.hypot(...pose.centre.map((v, i) => v - other.centre[i])) / extent);
      turn = Math.max(turn, 1 - Math.abs(pose.q.reduce((sum, v, i) => sum + v * other.q[i], 0)));
    }
    return { same: then.length === now.size, place, turn, points, all: stage.sample(1e9, null).length };
  });
  check(last.same && last.place < 2e-3 && last.turn < 1e-3 && last.points === last.all, `the last version is now ${JSON.stringify(last)}`);
  await page.getByRole("button", { name: "Now" }).click();
  check(await page.evaluate(() => window.psfm.stage.shownPoses().length) === status.placed, "now is now again");

  // View graph, colours, keys.
  await page.getByLabel("view graph").check();
  await page.getByLabel("cameras").uncheck();
  await page.getByLabel("cameras").check();
  for (const mode of ["error", "track", "cluster", "user", "colour"]) await page.getByLabel("Colour").selectOption(mode);
  await page.locator("canvas.stage").focus();
  const before = await page.evaluate(() => window.psfm.stage.camera.position.toArray());
  await page.keyboard.press("ArrowLeft");
  const after = await page.evaluate(() => window.psfm.stage.camera.position.toArray());
  check(before.some((v, i) => Math.abs(v - after[i]) > 1e-9), "arrow keys turn the model");
  await page.keyboard.press("f");
  await page.getByRole("tab", { name: "Photographs" }).click();
  await page.getByRole("searchbox").fill("");
  if (process.argv[3]) await page.screenshot({ path: path.join(process.argv[3], "viewer.png") });
  const serious = await accessible(page, ".side");
  check(serious.length === 0, `axe finds nothing serious ${serious.join("; ")}`);
  check(problems.length === 0, `no errors, and nothing from elsewhere ${problems.join("; ")}`);
  console.log(`${fs.statSync(file).size} bytes`);
}).catch((error) => { console.error(error); process.exit(1); });
