// For each file: one line of JSON with the header, the key/value data, the descriptor and the levels in base 64.
import { readFileSync } from "node:fs";
import { read } from "ktx-parse";

for (const path of process.argv.slice(2)) {
  const { vkFormat, pixelWidth, pixelHeight, layerCount, levels, dataFormatDescriptor, keyValue } = read(
    new Uint8Array(readFileSync(path)),
  );
  console.log(
    JSON.stringify({
      vkFormat,
      pixelWidth,
      pixelHeight,
      layerCount,
      keyValue,
      descriptor: dataFormatDescriptor[0],
      levels: levels.map((level) => Buffer.from(level.levelData).toString("base64")),
    }),
  );
}
