/** @file Which instant is shown: a solved frame, and while the machine plays how far it is on the way to the next. */

/** How often a still follows a still where motion is to be reduced [ms]. */
const STILLS = 400;
/** How long a run should take at the speed that is proposed [s]. */
const LONG_ENOUGH = 1.5;

/** The speeds to choose from: times true speed, as words. */
export const SPEEDS = [
  [100, "100 times faster"],
  [10, "10 times faster"],
  [1, "real time"],
  [0.5, "2 times slower"],
  [0.1, "10 times slower"],
  [0.01, "100 times slower"],
  [0.001, "1000 times slower"],
  [0.0001, "10000 times slower"],
];

/** The speed that is proposed for a run that lasts so long [s]: true speed, unless nothing could be seen. */
export function speedFor(duration) {
  const wanted = SPEEDS.find(([speed]) => duration / speed >= LONG_ENOUGH && (speed <= 1 || duration / speed >= 20));
  return (wanted ?? SPEEDS[SPEEDS.length - 1])[0];
}

/** The player. @property {number} frame @property {number} share of the way to the next frame, 0 where it stands */
export class Player {
  /** @param {Float64Array} time of the frames [s] @param {() => void} changed called after every change */
  constructor(time, changed) {
    this.time = time;
    this.changed = changed;
    this.frame = 0;
    this.share = 0;
    this.playing = false;
    this.repeats = true;
    this.speed = 1;
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
  }

  /** Stand at a frame. @param {number} frame */
  show(frame) {
    this.frame = Math.min(this.time.length - 1, Math.max(0, frame));
    this.share = 0;
    this.at = this.time[this.frame];
    this.changed();
  }

  /** Halt, and stand at a frame. @param {number} frame */
  halt(frame = this.frame) {
    this.playing = false;
    this.show(frame);
  }

  /** Play, or halt. */
  toggle() {
    if (this.playing) {
      this.halt();
      return;
    }
    if (this.frame === this.time.length - 1) this.show(0);
    this.playing = true;
    this.at = this.time[this.frame];
    this.last = null;
    requestAnimationFrame((now) => this.step(now));
    this.changed();
  }

  /** One image later. @param {number} now [ms] */
  step(now) {
    if (!this.playing) return;
    const passed = this.last === null ? 0 : now - this.last;
    if (this.last === null || !this.still.matches || passed >= STILLS) {
      this.last = now;
      this.advance((passed / 1000) * this.speed);
    }
    requestAnimationFrame((later) => this.step(later));
  }

  /** On by so much of the run's time [s]. */
  advance(by) {
    const end = this.time[this.time.length - 1];
    const span = end - this.time[0];
    this.at += by;
    if (this.at >= end) {
      if (!this.repeats) {
        this.halt(this.time.length - 1);
        return;
      }
      this.at = this.time[0] + ((this.at - this.time[0]) % span);
    }
    this.frame = this.frameAt(this.at);
    const step = this.time[this.frame + 1] - this.time[this.frame];
    this.share = this.still.matches || !(step > 0) ? 0 : (this.at - this.time[this.frame]) / step;
    this.changed();
  }

  /** The last frame that is not after an instant [s]. */
  frameAt(t) {
    let [low, high] = [0, this.time.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** The frame nearest to an instant [s]. */
  nearest(t) {
    const k = this.frameAt(t);
    const next = this.time[k + 1];
    return next !== undefined && next - t < t - this.time[k] ? k + 1 : k;
  }
}
