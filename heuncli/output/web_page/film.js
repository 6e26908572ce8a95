/** @file Draws pictures of the machine alone and leaves them as text, from which heun show makes PNG, GIF or video. */

import { prepareCase, readData } from "./data.js";
import { formatInstant } from "./digits.js";
import { findElement } from "./elements.js";
import { encodeGif } from "./gif.js";
import { getAxes } from "./histories.js";
import { LabelList } from "./labels.js";
import { Player, proposeSpeed } from "./player.js";
import { Selection } from "./selection.js";
import { drawMachine } from "./stage.js";
import { readColours } from "./strokes.js";
import { prepareView, View } from "./view.js";

const HEAD = 40; // pixels above the machine, for title and instant
const MAX_DURATION = 10; // s: of a film

/** Encode bytes as base64. @param {number[]} bytes */
function encodeBase64(bytes) {
  let text = "";
  for (let k = 0; k < bytes.length; k += 4096) text += String.fromCharCode(...bytes.slice(k, k + 4096));
  return btoa(text);
}

/** Draw title, load case and instant above the machine. */
function drawHead(pen, data, player, colours, width) {
  const { time } = data;
  const crank = getAxes(data)[1];
  const turn = crank ? `, ${crank.label} ${crank.values[player.frame].toFixed(0)}°` : "";
  const when = `t = ${formatInstant(time[player.frame], time[time.length - 1] - time[0], 4)} s${turn}`;
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

/** Make the function that draws the machine and its heading at an instant of a player, on one canvas. */
function makePicturePainter(data, width, height) {
  const colours = readColours();
  const labels = new LabelList();
  const view = new View(data.scene);
  const selection = new Selection(data);
  const canvas = findElement("machine");
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height - HEAD}px`;
  const whole = document.createElement("canvas");
  const fine = devicePixelRatio;
  [whole.width, whole.height] = [width * fine, height * fine];
  const pen = whole.getContext("2d", { willReadFrequently: true });
  return ({ frame, share }, player) => {
    drawMachine(canvas, data, view, { frame, share, ...selection.drawOptions }, colours, labels);
    pen.setTransform(fine, 0, 0, fine, 0, 0);
    pen.fillStyle = colours.panel;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(canvas, 0, HEAD, width, height - HEAD);
    drawHead(pen, data, player, colours, width);
    return whole;
  };
}

/** Choose the equidistant instants of a film [s]. */
function chooseInstants(data, rate) {
  const [first, end] = [data.time[0], data.time[data.count - 1]];
  const span = end - first;
  const long = Math.min(MAX_DURATION, span / proposeSpeed(span));
  const count = Math.max(2, Math.round(rate * long));
  return Array.from({ length: count }, (_, k) => first + (span * k) / count);
}

/** Draw what the data ask for: the picture of an instant, a GIF, or the pictures of a video. */
function drawFilm(data) {
  prepareView(data);
  const { kind, width, height, instant: wanted, rate } = data.film;
  const player = new Player(data.time, () => {});
  const picture = makePicturePainter(data, width, height);
  if (kind === "png" || data.count === 1) {
    player.show(wanted === null ? data.worst : player.findNearestFrame(wanted));
    return [picture(player, player).toDataURL("image/png").split(",")[1]];
  }
  const pictures = chooseInstants(data, rate).map((t) => {
    player.frame = player.findFrame(t);
    const step = data.time[player.frame + 1] - data.time[player.frame];
    player.share = step > 0 ? (t - data.time[player.frame]) / step : 0;
    const canvas = picture(player, player);
    if (kind === "frames") return canvas.toDataURL("image/png").split(",")[1];
    return canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  });
  if (kind === "frames") return pictures;
  const [wide, high] = [width, height].map((size) => Math.round(size * devicePixelRatio));
  return [encodeBase64(encodeGif(pictures, wide, high, 1 / rate))];
}

readData(findElement("data").textContent).then(([data]) => {
  findElement("film").textContent = drawFilm(prepareCase(data)).join(" ");
  document.documentElement.dataset.done = "yes";
});
