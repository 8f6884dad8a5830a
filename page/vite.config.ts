import { defineConfig } from "vite";

// One page, embedded into the program (src/editor/CMakeLists.txt): assets lie beside it and are asked for there.
// To work on it: `meshgraft edit --no-browser --port 8123`, MESHGRAFT_ENGINE=http://127.0.0.1:8123 npm run dev, and open
// what Vite prints with the engine's ?token=….
const engine = process.env["MESHGRAFT_ENGINE"] ?? "http://127.0.0.1:8123";
const forwarded = { target: engine, changeOrigin: true, ws: true, headers: { origin: engine } };

export default defineConfig({
  base: "./",
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: {
    outDir: process.env["MESHGRAFT_PAGE_OUT"] ?? "dist",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 4096,
    target: "es2022",
  },
  server: { proxy: { "/session": forwarded, "/upload": forwarded } },
  worker: { format: "es" },
});
