// NumPy's .npy format, as far as the daemon writes it: little-endian float32 and float64, C order.

const kinds = { "<f4": Float32Array, "<f8": Float64Array };

// { shape: [rows, columns], data, end } of the file that begins at a byte of the buffer; data is a view where its place allows.
export function readNpy(buffer, begin = 0) {
  const view = new DataView(buffer, begin);
  if (view.byteLength < 12 || view.getUint32(0) !== 0x934e554d || view.getUint16(4) !== 0x5059) {
    throw new Error("This is no NPY file.");
  }
  const isLong = view.getUint8(6) > 1;
  const start = begin + (isLong ? 12 : 10);
  const length = isLong ? view.getUint32(8, true) : view.getUint16(8, true);
  const header = new TextDecoder("latin1").decode(new Uint8Array(buffer, start, length));
  const kind = kinds[/'descr':\s*'([^']*)'/.exec(header)?.[1]];
  const shape = (/'shape':\s*\(([^)]*)\)/.exec(header)?.[1] ?? "").split(",").filter((n) => n.trim()).map(Number);
  if (!kind || /'fortran_order':\s*True/.test(header) || shape.length === 0) {
    throw new Error(`This NPY file is of another kind: ${header.trim()}`);
  }
  const n = shape.reduce((product, size) => product * size, 1);
  const offset = start + length;
  if (buffer.byteLength < offset + n * kind.BYTES_PER_ELEMENT) throw new Error("This NPY file is cut off.");
  const isAligned = offset % kind.BYTES_PER_ELEMENT === 0;
  const data = isAligned ? new kind(buffer, offset, n) : new kind(buffer.slice(offset), 0, n);
  return { shape, data, end: offset + n * kind.BYTES_PER_ELEMENT };
}
