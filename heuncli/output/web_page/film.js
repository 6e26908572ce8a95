/** @file Pictures of the machine without a page about it: drawn one after the other, and left as text for heun show. */

import { cloudOf, coverOf } from "./cloud.js";
import { coloursNow } from "./colours.js";
import { Chosen } from "./controls.js";
import { axesOf } from "./courses.js";
import { prepared, readData } from "./data.js";
import { instant } from "./digits.js";
import { findElement } from "./elements.js";
import { gifOf } from "./gif.js";
import { LabelList } from "./labels.js";
import { Player, speedFor } from "./player.js";
import { drawMachine } from "./stage.js";
import { View } from "./view.js";

const HEAD = 40; // pixels above the machine, for title and instant
const LONGEST = 10; // s: of a film

/** Bytes as base64. @param {number[]} bytes */
function base64(bytes) {
  let text = "";
  for (let k = 0; k < bytes.length; k += 4096) text += String.fromCharCode(...bytes.slice(k, k + 4096));
  return btoa(text);
}

/** Title, load case and instant above the machine. */
function drawHead(pen, data, player, colours, width) {
  const { time } = data;
  const crank = axesOf(data)[1];
  const turn = crank ? `, ${crank.label} ${crank.values[player.frame].toFixed(0)}°` : "";
  const when = `t = ${instant(time[player.frame], time[time.length - 1] - time[0], 4)} s${turn}`;
  pen.fillStyle = colours.paper;
  pen.fillRect(0, 0, width, HEAD);
  pen.fillStyle = colours.ink;
  pen.textBaseline = "middle";
  pen.font = "14px system-ui, sans-serif";
  const room = width - 40 - pen.measureText(when).width;
  pen.textAlign = "right";
  pen.fillText(when, width - 12, HEAD / 2);
  pen.textAlign = "left";
  pen.font = "bold 17px system-ui, sans-serif";
  pen.fillText(data.case ? `${data.title}: ${data.case}` : data.title, 12, HEAD / 2, room);
}

/** What makes the picture of where a player stands, as a canvas. */
function maker(data, width, height) {
  const colours = coloursNow();
  const labels = new LabelList();
  const view = new View(data.scene);
  const chosen = new Chosen(data, () => {});
  const drawn = findElement("machine");
  drawn.style.width = `${width}px`;
  drawn.style.height = `${height - HEAD}px`;
  const whole = document.createElement("canvas");
  const fine = devicePixelRatio;
  [whole.width, whole.height] = [width * fine, height * fine];
  const pen = whole.getContext("2d", { willReadFrequently: true });
  return ({ frame, share }, player) => {
    drawMachine(drawn, data, view, { frame, share, ...chosen.shown }, colours, labels);
    pen.setTransform(fine, 0, 0, fine, 0, 0);
    pen.fillStyle = colours.panel;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(drawn, 0, HEAD, width, height - HEAD);
    drawHead(pen, data, player, colours, width);
    return whole;
  };
}

/** The instants of a film [s], and how long each is shown [s]. */
function instantsOf(data, rate) {
  const [first, end] = [data.time[0], data.time[data.count - 1]];
  const span = end - first;
  const long = Math.min(LONGEST, span / speedFor(span));
  const count = Math.max(2, Math.round(rate * long));
  return Array.from({ length: count }, (_, k) => first + (span * k) / count);
}

/** Draw what is asked for: a picture of an instant, a GIF, or the pictures of a film. */
function draw(data) {
  data.scene.cloud = cloudOf(data.scene, data.count);
  data.scene.cover = coverOf(data.scene);
  const { kind, width, height, instant: wanted, rate } = data.film;
  const player = new Player(data.time, () => {});
  const picture = maker(data, width, height);
  if (kind === "png" || data.count === 1) {
    player.show(wanted === null ? data.worst : player.nearest(wanted));
    return [picture(player, player).toDataURL("image/png").split(",")[1]];
  }
  const pictures = instantsOf(data, rate).map((t) => {
    player.frame = player.frameAt(t);
    const step = data.time[player.frame + 1] - data.time[player.frame];
    player.share = step > 0 ? (t - data.time[player.frame]) / step : 0;
    const canvas = picture(player, player);
    if (kind === "frames") return canvas.toDataURL("image/png").split(",")[1];
    return canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  });
  if (kind === "frames") return pictures;
  const [wide, high] = [width, height].map((size) => Math.round(size * devicePixelRatio));
  return [base64(gifOf(pictures, wide, high, 1 / rate))];
}

readData(findElement("data").textContent).then(([data]) => {
  findElement("film").textContent = draw(prepared(data)).join(" ");
  document.documentElement.dataset.done = "yes";
});
