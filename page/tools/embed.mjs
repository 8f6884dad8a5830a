// Writes a C++ file with the bytes of every file of a folder: embed.mjs FOLDER OUT.cpp
import { readdir, readFile, writeFile } from "node:fs/promises";
import { extname, join, relative } from "node:path";

const [folder, out] = process.argv.slice(2);
const types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
  ".png": "image/png",
  ".txt": "text/plain; charset=utf-8",
};

async function files_in(path) {
  const entries = await readdir(path, { withFileTypes: true });
  const lists = entries.map((entry) =>
    entry.isDirectory() ? files_in(join(path, entry.name)) : [join(path, entry.name)],
  );
  return (await Promise.all(lists)).flat().sort();
}

// As a string literal, which compiles many times faster than a list of numbers. Octal escapes end by themselves.
function literal(bytes) {
  const lines = [];
  for (let at = 0; at < bytes.length; at += 4096) {
    let line = "";
    for (const byte of bytes.subarray(at, at + 4096)) {
      const plain = byte >= 32 && byte < 127 && byte !== 34 && byte !== 92 && byte !== 63;
      line += plain ? String.fromCharCode(byte) : `\\${byte.toString(8).padStart(3, "0")}`;
    }
    lines.push(`    "${line}"`);
  }
  return lines.length > 0 ? lines.join("\n") : '    ""';
}

const paths = await files_in(folder);
const entries = await Promise.all(
  paths.map(async (path) => {
    const bytes = await readFile(path);
    const type = types[extname(path)] ?? "application/octet-stream";
    return `    {"/${relative(folder, path)}", "${type}", std::string_view(\n${literal(bytes)}, ${bytes.length})},`;
  }),
);
await writeFile(
  out,
  `// Made by page/tools/embed.mjs.
#include <array>
#include <string_view>

#include "editor/page.h"

namespace meshgraft::editor {

std::span<const PageFile> page_files() {
  static constexpr std::array<PageFile, ${paths.length}> files{{
${entries.join("\n")}
  }};
  return files;
}

}  // namespace meshgraft::editor
`,
);
