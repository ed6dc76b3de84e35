// A frame's picture on a canvas.

/// The decoded picture of a frame that is to be shown, else null; close() it.
export async function decodedOf(session, frame) {
  let bitmap = null;
  try {
    bitmap = await createImageBitmap(new Blob([frame.picture], {type: frame.type}));
  } catch {
    session.addLog({level: 'warning', text: `a picture of the view ${frame.view} could not be decoded`});
  }
  const passes = session.passes(frame);
  if (bitmap && passes) return bitmap;
  bitmap?.close();
  return null;
}

/// Fills a canvas of the frame's size with the picture, which may have fewer pixels.
export function paint(canvas, frame, bitmap) {
  if (canvas.width !== frame.width || canvas.height !== frame.height) {
    canvas.width = frame.width;
    canvas.height = frame.height;
  }
  const context = canvas.getContext('2d', {alpha: false});
  // What is transparent lies on black, not on the picture before.
  context.fillStyle = '#000';
  context.fillRect(0, 0, frame.width, frame.height);
  context.drawImage(bitmap, 0, 0, frame.width, frame.height);
}
