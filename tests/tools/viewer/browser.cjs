// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests of pages share: a browser, sessions, and a way to end. psfm's own programs are under BUILD.
const fs = require("fs");
const os = require("os");
const path = require("path");
const { execFileSync } = require("child_process");

const SKIPPED = 77;
const BUILD = process.argv[2];
const CHROMIUM = process.env.PSFM_CHROMIUM ?? "/usr/bin/chromium";

function need(name) {
  try {
    return require(name);
  } catch {
    console.log(`skipped: ${name} is not there (npm ci in tools/viewer)`);
    process.exit(SKIPPED);
  }
}

async function browser() {
  const { chromium } = need("playwright-core");
  if (!fs.existsSync(CHROMIUM)) {
    console.log("skipped: there is no chromium (tools/install-packages --browser)");
    process.exit(SKIPPED);
  }
  return chromium.launch({ executablePath: CHROMIUM,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
}

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "psfm-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));

function psfm(...words) {
  return execFileSync(path.join(BUILD, "psfm"), words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

/** axe on a part of a page: nothing serious. */
async function accessible(page, part) {
  await page.addScriptTag({ content: fs.readFileSync(require.resolve("axe-core/axe.min.js"), "utf8") }).catch(() => {});
  const found = await page.evaluate(async (selector) => {
    if (!window.axe) return null;
    const result = await window.axe.run(selector);
    return result.violations.filter((v) => v.impact === "serious" || v.impact === "critical")
      .map((v) => `${v.id}: ${v.nodes.map((n) => n.html).slice(0, 3).join(" ")}`);
  }, part);
  return found;
}

function check(condition, what) {
  if (!condition) throw new Error(what);
  console.log(`ok: ${what}`);
}

async function run(test) {
  const chrome = await browser();
  try {
    await test(chrome);
  } finally {
    await chrome.close();
  }
}

module.exports = { BUILD, folder, psfm, accessible, check, run };
