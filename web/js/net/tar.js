// Makes a tar of files without reading them: the headers are written here, the contents stay the browser's blobs (IEEE 1003.1, ustar, pax).

const block = 512;
const encoder = new TextEncoder();

const octal = (value, digits) => `${value.toString(8).padStart(digits, '0')}\0`;

function header(name, size, seconds, type) {
  const bytes = new Uint8Array(block);
  const put = (text, at) => bytes.set(encoder.encode(text), at);
  bytes.set(encoder.encode(name).subarray(0, 100), 0);
  put(octal(0o644, 7), 100);
  put(octal(0, 7), 108);
  put(octal(0, 7), 116);
  put(size < 2 ** 33 ? octal(size, 11) : octal(0, 11), 124); // a larger size is in the pax record
  put(octal(seconds, 11), 136);
  put('        ', 148);
  put(type, 156);
  put('ustar\u000000', 257);
  put(
    octal(
      bytes.reduce((sum, byte) => sum + byte, 0),
      6,
    ),
    148,
  );
  return bytes;
}

const padding = (size) => new Uint8Array((block - (size % block)) % block);

/** A pax record, "27 path=…\n"; the number is the length of the whole record. */
function record(key, value) {
  const rest = encoder.encode(` ${key}=${value}\n`).length;
  let length = rest + 1;
  while (length !== rest + String(length).length) length = rest + String(length).length;
  return `${length} ${key}=${value}\n`;
}

const isPlain = (name) => /^[\x20-\x7e]{1,100}$/.test(name);

/**
 * @param {{path: string, file: Blob & {lastModified?: number}}[]} files relative paths with "/"
 * @returns {Blob}
 */
export function tarOf(files) {
  const parts = [];
  for (const { path, file } of files) {
    const seconds = Math.max(0, Math.floor((file.lastModified ?? 0) / 1000));
    let extra = '';
    if (!isPlain(path)) extra += record('path', path);
    if (file.size >= 2 ** 33) extra += record('size', file.size);
    if (extra) {
      const bytes = encoder.encode(extra);
      parts.push(header('pax', bytes.length, seconds, 'x'), bytes, padding(bytes.length));
    }
    parts.push(header(isPlain(path) ? path : 'file', file.size, seconds, '0'), file, padding(file.size));
  }
  parts.push(new Uint8Array(2 * block));
  return new Blob(parts, { type: 'application/x-tar' });
}

const archive = /\.(zip|tar|tgz|txz|tbz2?|tzst|tar\.(gz|xz|bz2|zst))$/i;

/** The body to upload for chosen files: a single archive as it is, everything else as a tar. */
export function bodyOf(files) {
  const [only] = files;
  if (files.length === 1 && archive.test(only.path)) {
    const type = /\.zip$/i.test(only.path)
      ? 'application/zip'
      : /\.tar$/i.test(only.path)
        ? 'application/x-tar'
        : 'application/octet-stream';
    return { name: only.path.split('/').at(-1).replace(archive, ''), body: only.file, type };
  }
  const top = only.path.split('/')[0];
  const isFolder = only.path.includes('/') && files.every(({ path }) => path.startsWith(`${top}/`));
  return { name: isFolder ? top : top.replace(/\.[^/]*$/, ''), body: tarOf(files), type: 'application/x-tar' };
}
