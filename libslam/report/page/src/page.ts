import { enlivenCharts } from "./charts";
import { linkMaps } from "./maps";
import { Player } from "./player";
import { readReplays } from "./replay_data";
import { enliven } from "./tables";

enliven();
linkMaps();
enlivenCharts();
const replays = readReplays();
const root = document.getElementById("player");
if (replays && root) new Player(replays, root);
