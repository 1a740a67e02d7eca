// browser.mjs PAGE COMPARISON CHROMIUM: opens the page as a reader would and tries everything that moves.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../../libslam/report/page/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const { HtmlValidate } = require("html-validate");
const axeSource = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const [pagePath, comparison, executablePath] = process.argv.slice(2);
const address = pathToFileURL(pagePath).href;
const problems = [];
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

async function open(hash = "", options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    if (/^https?:/.test(request.url())) problems.push(`asks for ${request.url()}`);
  });
  await page.goto(address + hash);
  return page;
}

const shown = (page) =>
  page.locator("#player").evaluate((player) => ({
    time: Number(player.dataset.time),
    pose: player.dataset.pose.split(" ").map(Number),
  }));

const truth = readFileSync(`${comparison}/log/run.gt.tum`, "utf8")
  .split("\n")
  .filter((line) => line && !line.startsWith("#"))
  .map((line) => line.split(" ").map(Number));
const near = (value, expected, what) =>
  assert.ok(Math.abs(value - expected) < 1e-3, `${what}: found ${value}, expected ${expected}`);

const checks = {
  async "the address opens the moment, and the pose is the true one of that moment"() {
    const page = await open("#t=8.4");
    const { time, pose } = await shown(page);
    near(time, 8.4, "time");
    const [, x, y] = truth.find(([stamp]) => Math.abs(stamp - truth[0][0] - 8.4) < 1e-3);
    near(pose[0], x, "x");
    near(pose[1], y, "y");
    await page.evaluate(() => (location.hash = "#t=3"));
    await page.waitForFunction(() => document.getElementById("player").dataset.time === "3.000");
  },

  async "steps, keys and the slider move by scans"() {
    const page = await open();
    const start = await shown(page);
    near(start.time, 0, "start");
    await page.getByRole("button", { name: "One scan on" }).click();
    const second = truth[1][0] - truth[0][0];
    near((await shown(page)).time, second, "step");
    await page.locator("h1").click();
    await page.keyboard.press("ArrowRight");
    near((await shown(page)).time, truth[2][0] - truth[0][0], "arrow");
    await page.keyboard.press("End");
    near((await shown(page)).time, truth.at(-1)[0] - truth[0][0], "end");
    await page.keyboard.press("Home");
    near((await shown(page)).time, 0, "home");
    await page.getByRole("slider", { name: "Scan" }).fill("10");
    near((await shown(page)).time, truth[10][0] - truth[0][0], "slider");
  },

  async "play runs to the end and stops there"() {
    const page = await open();
    await page.getByLabel("Speed").selectOption("50");
    await page.getByRole("button", { name: "Play or pause" }).click();
    await page.waitForFunction(() => Number(document.getElementById("player").dataset.time) > 19.5);
    await page.waitForFunction(() => document.querySelector("button[title^=Play]").textContent === "Play");
  },

  async "a click on the chart goes to its moment"() {
    const page = await open();
    const chart = page.locator("#error-chart");
    await chart.scrollIntoViewIfNeeded();
    const box = await chart.boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    const { time } = await shown(page);
    assert.ok(time > 8 && time < 12, `found ${time} s`);
    const x = Number(await chart.locator(".cursor").getAttribute("x1"));
    const { left, right, duration } = await chart.evaluate((element) => ({ ...element.dataset }));
    near(x, Number(left) + ((right - left) * time) / duration, "cursor");
  },

  async "sorting sorts by number, both ways"() {
    const page = await open();
    const table = page.locator("table.sortable").first();
    const column = () =>
      table.locator("tbody tr").evaluateAll((rows) => rows.map((row) => Number(row.cells[1].dataset.value)));
    const up = (await column()).sort((a, b) => a - b);
    const head = table.getByRole("columnheader").nth(1);
    await head.getByRole("button").click();
    assert.deepEqual(await column(), up);
    assert.equal(await head.getAttribute("aria-sort"), "ascending");
    await head.getByRole("button").click();
    assert.deepEqual(await column(), [...up].reverse());
    await table.getByRole("columnheader").first().getByRole("button").click();
    const names = await table.locator("tbody th").allTextContents();
    assert.deepEqual(names, [...names].sort());
  },

  async "the filter hides other rows"() {
    const page = await open();
    await page.getByLabel("Rows with").first().fill("GRAPH");
    const rows = page.locator("table.sortable").first().locator("tbody tr:visible");
    assert.deepEqual(await rows.locator("th").allTextContents(), ["graph"]);
  },

  async "zooming one map zooms all"() {
    const page = await open();
    const boxes = () => page.locator("svg.map").evaluateAll((maps) => maps.map((map) => map.getAttribute("viewBox")));
    const before = (await boxes())[0];
    await page.getByRole("button", { name: "Zoom in" }).first().click();
    const after = new Set(await boxes());
    assert.equal(after.size, 1);
    assert.ok(!after.has(before));
    await page.getByRole("button", { name: "Show the whole map" }).first().click();
    assert.deepEqual([...new Set((await boxes()).map((box) => box.split(" ").map((n) => Number(n).toFixed(2)).join(" ")))], [before]);
  },

  async "every choice of the player draws"() {
    const page = await open("#t=10");
    const ink = () => page.locator(".replay-map").evaluate((canvas) => canvas.toDataURL());
    const seen = new Set();
    const under = page.getByLabel("Under it");
    for (const value of await under.locator("option").evaluateAll((all) => all.map((one) => one.value))) {
      await under.selectOption(value);
      seen.add(await ink());
    }
    // The plan, five maps, five growing ones, nothing: no two look alike.
    assert.equal(seen.size, 12);
    const before = await ink();
    for (const box of await page.locator("#player input[type=checkbox]").all()) await box.uncheck();
    assert.notEqual(await ink(), before);
  },

  async "nothing is wider than a telephone"() {
    const page = await open("", { viewport: { width: 390, height: 800 } });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  },

  async "without script tables, maps and plots are there"() {
    const context = await browser.newContext({ javaScriptEnabled: false });
    const page = await context.newPage();
    await page.goto(address);
    assert.ok(await page.locator("noscript p").isVisible());
    assert.ok(await page.locator("#error-chart").isVisible());
    assert.equal(await page.locator("#runs svg.map").count(), 15);
  },

  async "axe finds nothing serious, light and dark"() {
    for (const colorScheme of ["light", "dark"]) {
      const page = await open("#t=5", { colorScheme });
      await page.addScriptTag({ content: axeSource });
      const { violations } = await page.evaluate(() => axe.run());
      const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      assert.deepEqual(
        serious.map(({ id, nodes }) => `${colorScheme}: ${id}: ${nodes[0].html.slice(0, 200)}`),
        [],
      );
    }
  },

  async "html-validate passes"() {
    const validator = new HtmlValidate({ extends: ["html-validate:recommended"] });
    const report = await validator.validateString(readFileSync(pagePath, "utf8"));
    const messages = report.results.flatMap(({ messages: all }) => all);
    assert.deepEqual(
      messages.map(({ line, ruleId, message }) => `${line}: ${ruleId}: ${message}`).slice(0, 20),
      [],
    );
  },
};

let failed = 0;
for (const [name, check] of Object.entries(checks)) {
  problems.length = 0;
  try {
    await check();
    assert.deepEqual(problems, []);
    console.log(`ok      ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAILED  ${name}\n${error.message}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
