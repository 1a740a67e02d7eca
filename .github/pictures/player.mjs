// The report's player as a picture: node player.mjs REPORT.html OUT.png SECONDS CHROMIUM
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(new URL("../../libslam/report/page/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const [report, picture, seconds, executablePath] = process.argv.slice(2);

const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
await page.goto(`${pathToFileURL(report)}#t=${seconds}`);
await page.locator("#replay").screenshot({ path: picture });
await browser.close();
