// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// How long a page takes to show a stored session, and how fluently it turns: no test, figures for docs/serve.md.
// usage: NODE_PATH=tools/viewer/node_modules node tests/tools/viewer/page_bench.cjs BUILD SESSION [LOADS]
const { run, serve } = require("./browser.cjs");

const [, , , SESSION, LOADS = "5"] = process.argv;
const TURNS = 60;

/** In the page, before its scripts: the end of each frame, with how many points it had. */
function note_frames() {
  window.frames_seen = [];
  const before = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (act) => before((time) => {
    act(time);
    const drawn = window.psfm?.stage?.drawn ?? 0; // a frame ends with readPixels, so what it drew is there
    if (drawn > 0) window.frames_seen.push([performance.now(), drawn]);
  });
}

async function load(page, url) {
  await page.goto(url);
  await page.waitForFunction(() => {
    const { psfm, frames_seen } = window;
    const whole = psfm?.stage && [...psfm.model.clusters.values()].reduce((n, c) => n + c.slots, 0);
    return whole > 0 && document.documentElement.dataset.state === "ready" && frames_seen.at(-1)?.[1] === whole;
  }, null, { timeout: 60000 });
  return page.evaluate(() => ({ first: window.frames_seen[0][0] / 1000, points: window.frames_seen[0][1],
    all: window.frames_seen.at(-1)[0] / 1000, drawn: window.frames_seen.at(-1)[1] }));
}

async function turning(page) {
  return page.evaluate(async (turns) => {
    const frame = () => new Promise((ended) => requestAnimationFrame(ended));
    const { stage } = window.psfm;
    for (let i = 0; i < 20; ++i) { stage.turn(0.02, 0); await frame(); } // finds its level of detail
    const start = performance.now();
    for (let i = 0; i < turns; ++i) { stage.turn(0.02, 0); await frame(); }
    return { frames_per_second: turns / ((performance.now() - start) / 1000), points: stage.drawn };
  }, TURNS);
}

run(async (chrome) => {
  const server = await serve("view", SESSION);
  const loads = [];
  let turned = null, heap = 0;
  const round = (number) => Math.round(number * 100) / 100;
  try {
    const context = await chrome.newContext({ viewport: { width: 1280, height: 800 } });
    for (let i = 0; i < Number(LOADS); ++i) {
      const page = await context.newPage();
      await page.addInitScript(note_frames);
      loads.push(await load(page, server.url));
      if (i === 0) turned = await turning(page);
      const debug = await context.newCDPSession(page);
      await debug.send("HeapProfiler.collectGarbage");
      const used = await debug.send("Runtime.getHeapUsage");
      heap = (used.usedSize + (used.backingStorageSize ?? 0)) / 1e6;
      await page.close();
    }
  } finally {
    await server.end();
  }
  console.log(JSON.stringify({
    first_picture_s: loads.map((one) => round(one.first)), of_points: loads[0].points,
    all_points_s: loads.map((one) => round(one.all)), points: loads[0].drawn,
    turning: { frames_per_second: round(turned.frames_per_second), points: turned.points }, heap_mb: round(heap) }, null, 1));
});
