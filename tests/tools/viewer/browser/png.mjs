// PNG files of 8 bits, RGB or RGBA without interlace, as Chromium and Supple write them; and how far
// two pictures differ.

import {inflateSync} from 'node:zlib';

/// Pixels over black, three bytes each.
export function readPng(file) {
  let width, height, channels;
  const parts = [];
  for (let at = 8; at < file.length;) {
    const length = file.readUInt32BE(at), type = file.toString('latin1', at + 4, at + 8);
    const body = file.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') {
      [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
      channels = {2: 3, 6: 4}[body[9]];
      if (body[8] !== 8 || !channels || body[12]) throw new Error('a PNG of another kind');
    }
    if (type === 'IDAT') parts.push(body);
    at += 12 + length;
  }
  const raw = unfiltered(inflateSync(Buffer.concat(parts)), width * channels, height, channels);
  const pixels = new Uint8Array(width * height * 3);
  for (let p = 0; p < width * height; ++p) {
    const alpha = channels === 4 ? raw[4 * p + 3] / 255 : 1;
    for (let c = 0; c < 3; ++c) pixels[3 * p + c] = Math.round(raw[channels * p + c] * alpha);
  }
  return {width, height, pixels};
}

/// The filters of PNG, section 9 of its specification.
function unfiltered(data, stride, height, bytes) {
  const out = Buffer.alloc(stride * height);
  for (let row = 0; row < height; ++row) {
    const filter = data[row * (stride + 1)];
    for (let i = 0; i < stride; ++i) {
      const at = row * stride + i;
      const left = i >= bytes ? out[at - bytes] : 0, up = row ? out[at - stride] : 0;
      const corner = row && i >= bytes ? out[at - stride - bytes] : 0;
      out[at] = data[row * (stride + 1) + 1 + i] + [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
    }
  }
  return out;
}
function paeth(left, up, corner) {
  const guess = left + up - corner;
  const [a, b, c] = [Math.abs(guess - left), Math.abs(guess - up), Math.abs(guess - corner)];
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

/// Mean and largest difference of two pictures, in parts of 255; and the mean brightness of the first.
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) return {mean: Infinity, most: Infinity, brightness: 0};
  let sum = 0, most = 0, light = 0;
  a.pixels.forEach((value, i) => {
    const off = Math.abs(value - b.pixels[i]);
    sum += off;
    light += value;
    most = Math.max(most, off);
  });
  return {mean: sum / a.pixels.length, most, brightness: light / a.pixels.length};
}

/// What is left where squares of 8 x 8 pixels are one: how fonts draw a letter is gone, where it stands is not.
export function coarse({width, height, pixels}) {
  const side = 8, small = {width: Math.floor(width / side), height: Math.floor(height / side)};
  small.pixels = new Uint8Array(small.width * small.height * 3);
  for (let y = 0; y < small.height; ++y) for (let x = 0; x < small.width; ++x) for (let c = 0; c < 3; ++c) {
    let sum = 0;
    for (let n = 0; n < side * side; ++n) {
      sum += pixels[3 * ((side * y + Math.floor(n / side)) * width + side * x + n % side) + c];
    }
    small.pixels[3 * (small.width * y + x) + c] = Math.round(sum / (side * side));
  }
  return small;
}

/// The part of all values that are further apart than `limit`, of 255.
export function partBeyond(a, b, limit) {
  if (a.width !== b.width || a.height !== b.height) return 1;
  return a.pixels.reduce((sum, value, i) => sum + (Math.abs(value - b.pixels[i]) > limit), 0) / a.pixels.length;
}
