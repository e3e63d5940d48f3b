// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// An open page that follows a server, for cluster_test.py: when it showed what, until standard input ends, and then
// whether its model is the snapshot's. Usage: follow.cjs BUILD LINK
const { run } = require("./browser.cjs");

/** In the page: times [s since 1970] of states in the list and of versions that have been drawn. */
function take_notes() {
  const { list, stage, model } = window.psfm, notes = window.notes = { images: {}, versions: [] }, now = () => Date.now() / 1000;
  const update = list.update.bind(list), refresh = stage.refresh.bind(stage);
  list.update = (facts) => {
    update(facts);
    for (const fact of facts) if (fact.reason !== "solving") notes.images[fact.name] ??= now();
  };
  stage.refresh = () => {
    refresh();
    const version = model.version;
    requestAnimationFrame(() => notes.versions.push([now(), version]));
  };
}

/** In the page: what it has and the snapshot has not, or the other way round; empty: nothing. */
async function difference() {
  const NOWHERE = 0xffffffff, EXACT = 5e-4, mean = (values) => values.reduce((sum, x) => sum + x, 0) / values.length;
  const { model, source } = window.psfm, fresh = new model.constructor();
  fresh.apply(await source.scene());
  const of = (one) => JSON.stringify([...one.clusters.values()].sort((a, b) => a.id - b.id).map((c) => [c.id, c.part, c.count, c.poses.size]));
  if (of(fresh) !== of(model)) return `${of(model)} instead of ${of(fresh)}`;
  for (const cluster of fresh.clusters.values()) {
    const shown = model.clusters.get(cluster.id), middle = [0, 1, 2].map((axis) => mean([...cluster.poses.values()].map((pose) => pose.centre[axis])));
    const extent = Math.max(...[...cluster.poses.values()].map((pose) => Math.hypot(...pose.centre.map((x, axis) => x - middle[axis]))));
    for (let slot = 0; slot < cluster.slots; ++slot) {
      if (cluster.born[slot] === NOWHERE) continue;
      const [there, here] = [cluster, shown].map((one) => one.positions.subarray(3 * slot, 3 * slot + 3));
      const away = Math.hypot(...there.map((x, axis) => x - middle[axis])); // far points are told in larger steps
      if (Math.hypot(...there.map((x, axis) => x - here[axis])) > EXACT * Math.max(extent, away)) return `a point of cluster ${cluster.id} lies elsewhere`;
    }
  }
  return "";
}

run(async (chrome) => {
  const page = await (await chrome.newContext({ viewport: { width: 1280, height: 800 } })).newPage();
  const problems = [];
  page.on("pageerror", (error) => problems.push(String(error)));
  await page.goto(process.argv[3]);
  await page.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
  await page.evaluate(take_notes);
  await new Promise((ended) => process.stdin.on("end", ended).resume());
  let unlike = "";
  for (let tries = 0; tries < 20 && (tries === 0 || unlike !== ""); ++tries) {
    if (tries > 0) await page.waitForTimeout(1000);
    unlike = await page.evaluate(difference);
  }
  const notes = await page.evaluate(() => window.notes);
  const counts = await page.evaluate(() => ({ listed: window.psfm.session.image_list.length, notice: document.querySelector(".notice")?.textContent }));
  console.log(JSON.stringify({ ...notes, ...counts, problems, difference: unlike }));
});
