import { linkMaps } from "./maps";
import { Player } from "./player";
import { readReplay } from "./replay_data";
import { enliven } from "./tables";

enliven();
linkMaps();
const replay = readReplay();
const root = document.getElementById("player");
if (replay && root && replay.times.length > 0) new Player(replay, root);
