// SPDX-License-Identifier: BSD-3-Clause
// People by a YOLOv5 network in Node, with onnxruntime-node (npm install --ignore-scripts onnxruntime-node).
//   hmcdyn_slam --detector command --command 'node yolo_boxes.mjs yolov5n.onnx' ...
import { readSync, writeSync } from 'node:fs';
import { basename } from 'node:path';
import ort from 'onnxruntime-node';

const side = 640;
const session = await ort.InferenceSession.create(process.argv[2]);
const say = (message) => writeSync(1, JSON.stringify(message) + '\n');

function read(size) { // so many bytes of the standard input, or null at its end
  const data = Buffer.alloc(size);
  for (let done = 0; done < size;) {
    const got = readSync(0, data, done, size - done);
    if (got === 0) return null;
    done += got;
  }
  return data;
}
function readLine() {
  let line = '';
  for (let byte; (byte = read(1)) !== null; line += byte) if (byte[0] === 10) return line;
  return null;
}
const overlap = (a, b) => { // intersection over union
  const w = Math.min(a[2], b[2]) - Math.max(a[0], b[0]), h = Math.min(a[3], b[3]) - Math.max(a[1], b[1]);
  const area = (box) => (box[2] - box[0]) * (box[3] - box[1]);
  return w <= 0 || h <= 0 ? 0 : w * h / (area(a) + area(b) - w * h);
};

async function find(pixels, width, height) { // pixels: blue, green, red
  const scale = side / Math.max(width, height);
  const left = (side - Math.round(width * scale)) >> 1, top = (side - Math.round(height * scale)) >> 1;
  const input = new Float32Array(3 * side * side).fill(114 / 255);
  for (let y = top; y < side - top; ++y) for (let x = left; x < side - left; ++x) { // bilinear
    const u = Math.min(Math.max((x - left + 0.5) / scale - 0.5, 0), width - 1), v = Math.min(Math.max((y - top + 0.5) / scale - 0.5, 0), height - 1);
    const u0 = Math.floor(u), v0 = Math.floor(v), u1 = Math.min(u0 + 1, width - 1), v1 = Math.min(v0 + 1, height - 1);
    for (let c = 0; c < 3; ++c) {
      const at = (column, row) => pixels[3 * (row * width + column) + 2 - c];
      const upper = at(u0, v0) + (u - u0) * (at(u1, v0) - at(u0, v0)), lower = at(u0, v1) + (u - u0) * (at(u1, v1) - at(u0, v1));
      input[(c * side + y) * side + x] = (upper + (v - v0) * (lower - upper)) / 255;
    }
  }
  const { [session.outputNames[0]]: { data } } = await session.run({ [session.inputNames[0]]: new ort.Tensor('float32', input, [1, 3, side, side]) });
  const boxes = []; // rows of 85: centre, size, objectness, 80 classes, of which 0 is a person
  for (let i = 0; i < data.length; i += 85) {
    const [x, y, w, h] = data.subarray(i, i + 4), score = data[i + 4] * data[i + 5];
    if (score >= 0.25) boxes.push([(x - w / 2 - left) / scale, (y - h / 2 - top) / scale, (x + w / 2 - left) / scale, (y + h / 2 - top) / scale, Math.min(score, 1), 'person']);
  }
  boxes.sort((a, b) => b[4] - a[4]);
  return boxes.reduce((kept, box) => kept.some((other) => overlap(box, other) > 0.45) ? kept : [...kept, box], []);
}

say({ hmcdyn_detector: 1, version: `${basename(process.argv[2])}, onnxruntime-node ${ort.env.versions.node}` });
for (let line; (line = readLine()) !== null;) {
  const { frame, width, height, bytes } = JSON.parse(line);
  const pixels = read(bytes);
  if (pixels === null) break;
  say({ frame, boxes: await find(pixels, width, height) });
}
