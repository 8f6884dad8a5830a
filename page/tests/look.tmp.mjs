import { chromium } from "playwright-core";
import { readFileSync } from "node:fs";
const url = readFileSync("/tmp/graftpage-engine.log","utf8").match(/token=(\w+)/)[1];
export async function start() {
  const browser = await chromium.launch({executablePath: "/usr/bin/chromium", args: ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader","--ignore-gpu-blocklist", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"]});
  const page = await browser.newPage({viewport: {width: 1280, height: 800}});
  page.on("pageerror", e => console.log("ERR", String(e).slice(0,400)));
  page.on("console", m => m.type() === "error" && console.log("CON", m.text().slice(0,300)));
  await page.goto(`http://127.0.0.1:8304/?token=${url}`);
  await page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
  return { browser, page };
}
