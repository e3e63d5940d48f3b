// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests of pages share: a browser, sessions, and a way to end. psfm's own programs are under BUILD.
const fs = require("fs");
const os = require("os");
const path = require("path");
const { execFileSync, spawn } = require("child_process");

const SKIPPED = 77;
const BUILD = process.argv[2];
const CHROMIUM = process.env.PSFM_CHROMIUM ?? "/usr/bin/chromium";

function need_file(name) {
  try {
    return require.resolve(name);
  } catch {
    console.log(`skipped: ${name} is not there (npm ci in tools/viewer)`);
    process.exit(SKIPPED);
  }
}

async function browser() {
  const { chromium } = require(need_file("playwright-core"));
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

/** psfm serve or psfm view on a port of its own. */
function serve(command, session, ...options) {
  return serve_at(0, command, session, ...options);
}
function serve_at(port, command, session, ...options) {
  return new Promise((resolve, reject) => {
    const child = spawn(path.join(BUILD, "psfm"), [command, "--session", session, "--listen", `127.0.0.1:${port}`, ...options]);
    let text = "";
    const end = () => new Promise((ended) => {
      child.removeAllListeners("exit");
      child.on("exit", ended);
      child.kill("SIGTERM");
    });
    child.stdout.on("data", (data) => {
      text += data;
      const found = /http:\/\/127\.0\.0\.1:\d+/.exec(text);
      if (found) resolve({ url: found[0], end });
    });
    child.stderr.on("data", (data) => { text += data; });
    child.on("exit", (code) => reject(new Error(`psfm ${command} ended with ${code}: ${text}`)));
  });
}

/** axe on a part of a page: what it finds serious. It comes as the debugger's own, which no policy of the page stops. */
async function accessible(page, part) {
  const debug = await page.context().newCDPSession(page);
  await debug.send("Runtime.evaluate", { expression: fs.readFileSync(need_file("axe-core/axe.min.js"), "utf8") });
  return page.evaluate(async (selector) => {
    const result = await window.axe.run(selector);
    return result.violations.filter((v) => v.impact === "serious" || v.impact === "critical")
      .map((v) => `${v.id}: ${v.nodes.map((n) => n.html).slice(0, 3).join(" ")}`);
  }, part);
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

module.exports = { BUILD, folder, psfm, serve, serve_at, accessible, check, run };
