/** @file The player: which frame is shown, and during playback how far the motion is on the way to the next. */

/** Time between pictures if the user's system asks for reduced motion [ms]. */
const REDUCED_INTERVAL = 400;
/** The shortest playback that can be followed [s]. */
const MIN_PLAYBACK = 1.5;

/** The speeds to choose from: factor of real time, words. */
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

/** Propose a speed for a duration [s]: real time, unless that is too fast to follow or takes very long. */
export function proposeSpeed(duration) {
  const choice = SPEEDS.find(([speed]) => duration / speed >= MIN_PLAYBACK && (speed <= 1 || duration / speed >= 20));
  return (choice ?? SPEEDS[SPEEDS.length - 1])[0];
}

/**
 * Moves through the frames.
 * @property {number} frame @property {number} share of the way to the next frame, 0 where it stands
 */
export class Player {
  /** @param {Float64Array} time of the frames [s] @param {() => void} redraw called after every change */
  constructor(time, redraw) {
    this.time = time;
    this.redraw = redraw;
    this.frame = 0;
    this.share = 0;
    this.playing = false;
    this.repeats = true;
    this.speed = 1;
    this.reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");
  }

  /** Show a frame. @param {number} frame */
  show(frame) {
    this.frame = Math.min(this.time.length - 1, Math.max(0, frame));
    this.share = 0;
    this.instant = this.time[this.frame];
    this.redraw();
  }

  /** Halt at a frame. @param {number} frame */
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
    this.instant = this.time[this.frame];
    this.lastImage = null;
    requestAnimationFrame((now) => this.step(now));
    this.redraw();
  }

  /** Advance to the next image. @param {number} now [ms] */
  step(now) {
    if (!this.playing) return;
    const passed = this.lastImage === null ? 0 : now - this.lastImage;
    if (this.lastImage === null || !this.reducedMotion.matches || passed >= REDUCED_INTERVAL) {
      this.lastImage = now;
      this.advance((passed / 1000) * this.speed);
    }
    requestAnimationFrame((later) => this.step(later));
  }

  /** Advance by a part of the run's time [s]. @param {number} duration */
  advance(duration) {
    const end = this.time[this.time.length - 1];
    const span = end - this.time[0];
    this.instant += duration;
    if (this.instant >= end) {
      if (!this.repeats) {
        this.halt(this.time.length - 1);
        return;
      }
      this.instant = this.time[0] + ((this.instant - this.time[0]) % span);
    }
    this.frame = this.findFrame(this.instant);
    const step = this.time[this.frame + 1] - this.time[this.frame];
    this.share = this.reducedMotion.matches || !(step > 0) ? 0 : (this.instant - this.time[this.frame]) / step;
    this.redraw();
  }

  /** Find the last frame at or before an instant [s]. */
  findFrame(t) {
    let [low, high] = [0, this.time.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Find the frame nearest to an instant [s]. */
  findNearestFrame(t) {
    const k = this.findFrame(t);
    const next = this.time[k + 1];
    return next !== undefined && next - t < t - this.time[k] ? k + 1 : k;
  }
}
