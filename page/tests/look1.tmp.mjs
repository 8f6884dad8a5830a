import { start } from "./look.tmp.mjs";
const { browser, page } = await start();
const t0 = Date.now();
await page.getByRole("button", {name: /bust/i}).first().click();
await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
await page.getByRole("tab", {name: "Graft"}).click();
await page.waitForTimeout(1500);
await page.screenshot({path: "/tmp/gp1.png"});
await page.getByRole("button", {name: "Add head"}).click();
await page.waitForFunction(() => window.meshgraft.editor.graft.preview.value !== null, undefined, {timeout: 45000}).catch(e => console.log("no preview"));
await page.waitForTimeout(3000);
await page.screenshot({path: "/tmp/gp2.png"});
console.log(await page.evaluate(() => JSON.stringify({r: window.meshgraft.editor.graft.report.value, s: window.meshgraft.editor.state.value.graft, m: window.meshgraft.editor.messages.value, p: window.meshgraft.editor.state.value.parts})));
for (const [name, file] of [["With part", "gp3"], ["Apart", "gp4"]]) {
  await page.getByText(name, {exact: true}).click();
  await page.waitForTimeout(1200);
  await page.screenshot({path: `/tmp/${file}.png`});
}
console.log(Date.now() - t0);
await browser.close();
