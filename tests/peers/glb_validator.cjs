// Whether files are glTF as the standard wants it, by Khronos's own validator (npm install gltf-validator).
// Usage: node glb_validator.cjs FILE.glb ...; one line of JSON a file; exits with 1 where any has an error.
const fs = require("fs");
const validator = require("gltf-validator");

async function main() {
  for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
    const { numErrors, numWarnings, messages } = report.issues;
    console.log(JSON.stringify({ file, errors: numErrors, warnings: numWarnings, messages }));
    if (numErrors > 0) process.exitCode = 1;
  }
}

main();
