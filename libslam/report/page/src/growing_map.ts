import { originOf, returnsOf, type Path, type Replay } from "./replay_data";

const kMostCells = 700; // on the longer side
const kFinestCell_m = 0.05;
const kHit = 4;
const kMiss = -1;
const kMost = 24;
const kLeast = -12;
const kCheckpoint = 200; // scans

/**
 * The map that the scans so far give, a grid of counts: a cell gains where a beam ends in it and loses where one goes through,
 * within bounds, so that what has moved fades.
 */
export class GrowingMap {
  private readonly columns: number;
  private readonly rows: number;
  private readonly cell_m: number;
  private counts: Int8Array;
  private drawn = 0;
  private readonly checkpoints: Int8Array[] = [];
  private readonly canvas = document.createElement("canvas");
  private readonly picture: ImageData;

  constructor(
    private readonly replay: Replay,
    readonly path: Path,
  ) {
    const { x0, y0, x1, y1 } = replay.window;
    this.cell_m = Math.max(kFinestCell_m, Math.max(x1 - x0, y1 - y0) / kMostCells);
    this.columns = Math.max(1, Math.ceil((x1 - x0) / this.cell_m));
    this.rows = Math.max(1, Math.ceil((y1 - y0) / this.cell_m));
    this.counts = new Int8Array(this.columns * this.rows);
    this.checkpoints.push(this.counts.slice());
    this.canvas.width = this.columns;
    this.canvas.height = this.rows;
    this.picture = new ImageData(this.columns, this.rows);
  }

  /** As it was after a scan. */
  at(index: number, dark: boolean): HTMLCanvasElement {
    if (this.drawn > index + 1) {
      const checkpoint = Math.floor((index + 1) / kCheckpoint);
      this.counts = this.checkpoints[checkpoint].slice();
      this.drawn = checkpoint * kCheckpoint;
    }
    for (; this.drawn <= index; ) {
      this.insert(this.drawn++);
      if (this.drawn === kCheckpoint * this.checkpoints.length) this.checkpoints.push(this.counts.slice());
    }
    this.paint(dark);
    return this.canvas;
  }

  private insert(index: number): void {
    const { scans, window } = this.replay;
    const pose = this.path.at(index);
    if (!scans || !pose) return;
    const toCell = (x: number, y: number): [number, number] => [
      Math.floor((x - window.x0) / this.cell_m),
      Math.floor((window.y1 - y) / this.cell_m),
    ];
    const origin = originOf(scans, pose);
    const from = toCell(origin.x, origin.y);
    const ends: [number, number][] = [];
    for (const [x, y] of returnsOf(scans, index, pose)) {
      const end = toCell(x, y);
      this.clear(from, end);
      ends.push(end);
    }
    // After all rays, so that one which grazes a wall does not wipe out what another has just found.
    for (const [column, row] of ends) this.add(column, row, kHit - kMiss);
  }

  private add(column: number, row: number, count: number): void {
    if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) return;
    const cell = row * this.columns + column;
    this.counts[cell] = Math.min(kMost, Math.max(kLeast, this.counts[cell] + count));
  }

  /** Every cell on the way, the last too. */
  private clear([column, row]: [number, number], [lastColumn, lastRow]: [number, number]): void {
    const steps = Math.max(Math.abs(lastColumn - column), Math.abs(lastRow - row));
    const [right, down] = steps > 0 ? [(lastColumn - column) / steps, (lastRow - row) / steps] : [0, 0];
    for (let i = 0; i <= steps; ++i) this.add(Math.round(column + i * right), Math.round(row + i * down), kMiss);
  }

  private paint(dark: boolean): void {
    const { data } = this.picture;
    const free = dark ? 0x0e : 0xff;
    const wall = dark ? 0xe0 : 0x26;
    for (let cell = 0; cell < this.counts.length; ++cell) {
      const count = this.counts[cell];
      const grey = count > 0 ? wall : free;
      data.fill(grey, 4 * cell, 4 * cell + 3);
      data[4 * cell + 3] = count === 0 ? 0 : count > 0 ? Math.min(255, 60 * count) : 255;
    }
    this.canvas.getContext("2d")!.putImageData(this.picture, 0, 0);
  }
}
