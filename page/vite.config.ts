import { readFileSync } from "node:fs";
import { defineConfig, type Plugin } from "vite";

// To work on it: `meshgraft edit --no-browser --port 8123`, MESHGRAFT_ENGINE=http://127.0.0.1:8123 npm run dev, and open
// what Vite prints with the engine's ?token=….
const engine = process.env["MESHGRAFT_ENGINE"] ?? "http://127.0.0.1:8123";
const forwarded = { target: engine, changeOrigin: true, ws: true, headers: { origin: engine } };

// What the page is made of asks that its licence goes along: /licences.txt.
function licences(): Plugin {
  const packages = ["three", "three-mesh-bvh", "preact", "@preact/signals", "@preact/signals-core"];
  return {
    name: "licences",
    generateBundle() {
      const texts = packages.map((name) => {
        const at = (file: string) => new URL(`node_modules/${name}/${file}`, import.meta.url);
        const { version } = JSON.parse(readFileSync(at("package.json"), "utf8")) as { version: string };
        return `${name} ${version}\n\n${readFileSync(at("LICENSE"), "utf8").trim()}\n`;
      });
      this.emitFile({ type: "asset", fileName: "licences.txt", source: texts.join(`\n${"-".repeat(80)}\n\n`) });
    },
  };
}

// One page, embedded into the program (CMakeLists.txt): assets lie beside it and are asked for there.
export default defineConfig({
  base: "./",
  plugins: [licences()],
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  server: { proxy: { "/session": forwarded, "/upload": forwarded } },
  worker: { format: "es" },
  build: {
    outDir: process.env["MESHGRAFT_PAGE_OUT"] ?? "dist",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 4096,
    target: "es2022",
  },
});
