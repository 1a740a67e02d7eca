// browser.mjs FOLDER CHROMIUM: opens the pages that browser.sh made there as a reader would, and tries everything that moves.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../../libslam/report/page/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const { HtmlValidate } = require("html-validate");
const axeSource = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const [folder, executablePath] = process.argv.slice(2);
const comparison = `${folder}/comparison`;
const kPages = ["comparison", "explorations", "exploration", "stress", "drives"];
const pathOf = (name) => `${folder}/${name}.html`;
const problems = [];
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

async function open(hash = "", options = {}, name = "comparison") {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    if (/^https?:/.test(request.url())) problems.push(`asks for ${request.url()}`);
  });
  await page.goto(pathToFileURL(pathOf(name)).href + hash);
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

  async "the scan's views are as high as the map beside them, and below it on a narrow screen"() {
    const page = await open();
    const box = (selector) => page.locator(selector).boundingBox();
    const map = await box(".replay-map");
    const scans = await box(".scans");
    assert.ok(Math.abs(map.height - scans.height) < 12, `found ${map.height} and ${scans.height} px`);
    assert.ok(scans.x > map.x + map.width);
    const narrow = await open("", { viewport: { width: 390, height: 800 } });
    const below = await narrow.locator(".scans").boundingBox();
    assert.ok(below.x < 40 && below.y > 0);
  },

  async "columns and events say what they mean"() {
    const page = await open();
    const heads = page.locator("table.sortable").first().locator("thead th");
    for (const head of await heads.all()) assert.ok(await head.getAttribute("title"), await head.textContent());
    const events = await open("", {}, "exploration");
    assert.match(await events.locator("#event-meanings").textContent(), /decision\s*the strategy chose/);
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

  async "names that repeat can be chosen, and rows go by all choices at once"() {
    const page = await open("", {}, "stress");
    const table = page.locator("table.sortable").first();
    const bar = page.locator(".bar.filter").first();
    const shownRows = () =>
      table.locator("tbody tr:visible").evaluateAll((rows) => rows.map((row) => [row.cells[0].textContent, row.cells[1].textContent]));
    await bar.getByLabel("method").selectOption({ label: "naive_flow" });
    assert.deepEqual(await shownRows(), [["60", "naive_flow"], ["210", "naive_flow"], ["360", "naive_flow"]]);
    await bar.getByLabel("lidar.fov_deg").selectOption({ label: "360" });
    assert.deepEqual(await shownRows(), [["360", "naive_flow"]]);
    assert.match(await bar.textContent(), /1 of 6 rows/);
    await bar.getByLabel("method").selectOption({ label: "any" });
    assert.deepEqual(await shownRows(), [["360", "naive_wheel"], ["360", "naive_flow"]]);
    // Sorting keeps what is hidden hidden.
    await table.getByRole("columnheader").nth(1).getByRole("button").click();
    assert.deepEqual(await shownRows(), [["360", "naive_flow"], ["360", "naive_wheel"]]);
  },

  async "a chart tells its values and intervals, and its names switch lines off"() {
    const page = await open("", {}, "stress");
    const figure = page.locator("figure", { has: page.locator("#stress-failures") });
    const chart = figure.locator("svg.chart");
    await chart.scrollIntoViewIfNeeded();
    const box = await chart.boundingBox();
    const { right, top } = await chart.evaluate((element) => ({ ...element.dataset }));
    const unit = box.width / 720;
    await page.mouse.move(box.x + (right - 62) * unit, box.y + (Number(top) + 40) * unit);
    const readout = figure.locator(".readout");
    assert.match(await readout.textContent(), /lidar.fov_deg 3\d\d: naive_wheel at 360: 0 \[0, 0.842\] · naive_flow at 360/);
    await figure.getByRole("button", { name: "naive_wheel" }).click();
    assert.equal(await figure.getByRole("button", { name: "naive_wheel" }).getAttribute("aria-pressed"), "false");
    assert.equal(await chart.locator("g[data-series='0']").getAttribute("visibility"), "hidden");
    await figure.locator("section").focus();
    await page.keyboard.press("ArrowRight");
    assert.doesNotMatch(await readout.textContent(), /naive_wheel/);
    assert.match(await readout.textContent(), /naive_flow/);
    await figure.getByRole("button", { name: "naive_wheel" }).click();
    assert.equal(await chart.locator("g[data-series='0']").getAttribute("visibility"), "visible");
  },

  async "every run of an exploration has its curves, goal and replay"() {
    const page = await open("#replay=2&t=6", {}, "explorations");
    const choice = page.getByLabel("Replay of");
    assert.equal(await choice.evaluate((select) => select.selectedOptions[0].textContent), "wall_follow");
    near((await shown(page)).time, 6, "time");
    await choice.selectOption({ label: "nearest_frontier" });
    near((await shown(page)).time, 0, "start of the other");
    assert.match(await page.locator(".poses").textContent(), /goal -?\d/);
    await page.locator("#coverage-path").hover();
    assert.match(await page.locator(".readout").first().textContent(), /path \(m\) [0-9.]+: nearest_frontier [0-9.]+ · wall_follow [0-9.]+/);
    await page.evaluate(() => (location.hash = "#replay=2&t=3"));
    await page.waitForFunction(() => document.getElementById("player").dataset.time === "3.000");
    // One cursor per joined chart and one robot per map, whichever replay is open.
    assert.equal(await page.locator("#paths .cursor").count(), 2);
  },

  async "a click in a list goes to its moment, and the lists follow the time"() {
    const page = await open("", {}, "exploration");
    const events = page.getByRole("group", { name: "Events" });
    const second = events.getByRole("button").nth(1);
    const at = parseFloat(await second.locator(".time").textContent());
    assert.ok(at > 0);
    await second.click();
    near((await shown(page)).time, at, "event");
    assert.match(await page.evaluate(() => location.hash), new RegExp(`t=${at.toFixed(1)}$`));
    const log = page.getByRole("group", { name: "Operation log" });
    await page.locator("h1").click();
    await page.keyboard.press("End");
    const last = log.locator("[aria-current]");
    assert.equal(parseFloat(await last.locator(".time").textContent()).toFixed(1), (await shown(page)).time.toFixed(1));
    await last.waitFor(); // the list draws its rows anew when it has scrolled
    const operation = await last.locator("code").textContent();
    const lines = readFileSync(`${folder}/exploration/run.operations.txt`, "utf8").trim().split("\n");
    assert.equal(operation.split(" ")[0], lines.at(-1).split(" ")[0]);
    near(Number(operation.split(" ")[1]), Number(lines.at(-1).split(" ")[1]), "reading");
    await log.getByRole("button").nth(2).click();
    assert.ok((await shown(page)).time < 15);
    // Only what is in view is there, however long the log.
    assert.ok((await log.getByRole("button").count()) < 40);
  },

  async "the list of events shows one kind when asked"() {
    const page = await open("");
    const lists = page.locator(".lists section").first();
    const select = lists.getByLabel("Show");
    const kinds = await select.locator("option").allTextContents();
    assert.match(kinds[0], /^all \d+$/);
    assert.ok(kinds.length > 1);
    await select.selectOption({ index: 1 });
    const kind = kinds[1].replace(/ \(\d+\)$/, "");
    for (const text of await lists.locator(".long-rows .words").allTextContents()) assert.ok(text.startsWith(kind), text);
  },

  async "a click on the marks over time goes there"() {
    const page = await open("", {}, "exploration");
    const marks = page.locator(".timeline");
    await marks.scrollIntoViewIfNeeded();
    const box = await marks.boundingBox();
    await page.mouse.click(box.x + box.width - 9, box.y + box.height / 2);
    assert.ok((await shown(page)).time > 14);
  },

  async "the map grows with time, and is the same when time goes back"() {
    const page = await open("#t=2", {}, "exploration");
    for (const box of await page.locator("#player input[type=checkbox]").all()) await box.uncheck();
    const ink = () => page.locator(".replay-map").evaluate((canvas) => canvas.toDataURL());
    const early = await ink();
    await page.evaluate(() => (location.hash = "#t=14"));
    await page.waitForFunction(() => document.getElementById("player").dataset.time === "14.000");
    assert.notEqual(await ink(), early);
    await page.evaluate(() => (location.hash = "#t=2"));
    await page.waitForFunction(() => document.getElementById("player").dataset.time === "2.000");
    assert.equal(await ink(), early);
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
    // The plan, five maps, nothing, and those that grow: by the truth, by each of five, and as two had it before they
    // corrected themselves, which may be the same.
    assert.ok(seen.size >= 13, `${seen.size} different pictures`);
    const before = await ink();
    for (const box of await page.locator("#player input[type=checkbox]").all()) await box.uncheck();
    assert.notEqual(await ink(), before);
  },

  async "nothing is wider than a telephone"() {
    for (const name of kPages) {
      const page = await open("", { viewport: { width: 390, height: 800 } }, name);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390, name);
      await page.close();
    }
  },

  async "without script tables, maps and plots are there"() {
    const context = await browser.newContext({ javaScriptEnabled: false });
    const page = await context.newPage();
    await page.goto(pathToFileURL(pathOf("comparison")).href);
    assert.ok(await page.locator("noscript p").isVisible());
    assert.ok(await page.locator("#error-chart").isVisible());
    assert.equal(await page.locator("#runs svg.map").count(), 15);
  },

  async "axe finds nothing serious, light and dark"() {
    for (const [name, colorScheme] of kPages.flatMap((one) => [[one, "light"], [one, "dark"]])) {
      const page = await open("#t=5", { colorScheme }, name);
      await page.addScriptTag({ content: axeSource });
      const { violations } = await page.evaluate(() => axe.run());
      const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      assert.deepEqual(
        serious.map(({ id, nodes }) => `${name}, ${colorScheme}: ${id}: ${nodes[0].html.slice(0, 200)}`),
        [],
      );
      await page.close();
    }
  },

  async "on paper all is light, nothing is cut, and what cannot be used is left out"() {
    const page = await open("", { colorScheme: "dark" }, "explorations");
    await page.emulateMedia({ media: "print" });
    assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
    for (const selector of ["#replay", ".bar", ".readout", "#downloads"])
      assert.equal(await page.locator(selector).first().isVisible(), false, selector);
    assert.equal(await page.locator("#coverage-path").isVisible(), true);
  },

  async "html-validate passes"() {
    const validator = new HtmlValidate({ extends: ["html-validate:recommended"] });
    for (const name of kPages) {
      const report = await validator.validateString(readFileSync(pathOf(name), "utf8"));
      const messages = report.results.flatMap(({ messages: all }) => all);
      assert.deepEqual(
        messages.map(({ line, ruleId, message }) => `${name}:${line}: ${ruleId}: ${message}`).slice(0, 20),
        [],
      );
    }
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
