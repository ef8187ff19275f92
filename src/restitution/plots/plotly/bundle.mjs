// Makes plotly.min.js.gz: the part of plotly.js that draws the figures of `plots/`, 1 MB instead of 5. In this folder:
//   npm install --no-save --ignore-scripts plotly.js@4.1.1 esbuild@0.28.2 && node bundle.mjs && rm -r node_modules
import { build } from "esbuild";
import { copyFile, readFile, writeFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";

// Descriptions of attributes, which no page shows: strings and joined lists of strings.
const TEXT = String.raw`'(?:[^'\\\n]|\\.)*'|"(?:[^"\\\n]|\\.)*"`;
const TEXTS = String.raw`\[(?:\s*(?:${TEXT})\s*,?)*\s*\]\s*\.join\([^)]*\)`;
const DESCRIPTION = new RegExp(String.raw`\bdescription:\s*(?:${TEXTS}|${TEXT})(?=\s*[,}])`, "g");
const undescribed = {
  name: "undescribed",
  setup: (bundle) => bundle.onLoad({ filter: /plotly\.js\/src\/.*\.js$/ }, async ({ path }) => ({
    contents: (await readFile(path, "utf8")).replace(DESCRIPTION, 'description: ""'), loader: "js",
  })),
};

const { version } = JSON.parse(await readFile("node_modules/plotly.js/package.json", "utf8"));
const made = await build({
  stdin: {
    contents: 'const Plotly = require("plotly.js/lib/core");\n'
      + 'Plotly.register([require("plotly.js/lib/heatmap")]);\nmodule.exports = Plotly;\n',
    resolveDir: ".",
  },
  banner: { js: `/* plotly.js ${version} (scatter, heatmap), (c) Plotly, Inc., MIT license */` },
  bundle: true, minify: true, format: "iife", globalName: "Plotly", target: "es2020", legalComments: "eof",
  define: { global: "window", "define.amd": "false" },
  loader: { ".css": "empty" }, // that of maps of the Earth
  plugins: [undescribed], write: false,
});
await writeFile("plotly.min.js.gz", gzipSync(made.outputFiles[0].contents, { level: 9 }));
await copyFile("node_modules/plotly.js/LICENSE", "LICENSE");
