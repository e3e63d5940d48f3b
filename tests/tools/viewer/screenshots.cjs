// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The pictures of docs/serve.md, of a session that is there. Usage: screenshots.cjs BUILD SESSION FOLDER
// Those in docs/serve were made of: psfm-render-scene court --images 40; psfm run court/images --session courtyard.
const path = require("path");
const { serve, run } = require("./browser.cjs");

const SIZE = { width: 1000, height: 620 };

run(async (chrome) => {
  const [session, folder] = process.argv.slice(3);
  const server = await serve("view", session);
  try {
    const page = await (await chrome.newContext({ viewport: SIZE })).newPage();
    const picture = async (name) => {
      await page.mouse.move(0, 0);
      await page.waitForTimeout(1500); // all points are drawn
      await page.screenshot({ path: path.join(folder, `${name}.png`) });
    };
    await page.goto(server.url);
    await page.waitForFunction(() => document.documentElement.dataset.state === "ready", null, { polling: 100, timeout: 60000 });
    await picture("viewer");
    await page.locator(".row").nth(2).click();
    await page.waitForFunction(() => document.querySelector(".picture img")?.naturalWidth > 0, null, { polling: 200, timeout: 30000 });
    await page.getByLabel("view graph").check();
    await page.getByLabel("Colour").selectOption("track");
    await page.evaluate(() => { const { stage } = window.psfm; stage.fit(); stage.turn(0.6, -0.25); stage.zoom(0.75); });
    await picture("photograph");
  } finally {
    await server.end();
  }
}).catch((error) => { console.error(error); process.exit(1); });
