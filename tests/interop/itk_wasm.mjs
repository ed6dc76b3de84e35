// ITK as compiled for npm reads transforms and images: node itk_wasm.mjs NODE_MODULES FILE…
// The values of each go to FILE.values, its grid as a line of JSON to the standard output; a transform that supple wrote
// (.h5) is written again as FILE.itk.h5 and FILE.itk.tfm.
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, ...files] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(resolve(modules, "@itk-wasm", name, "dist/index-node.js")).href);
const { readTransformNode, writeTransformNode } = await load("transform-io");
const { readImageNode } = await load("image-io");

function tell(file, values, told) {
  writeFileSync(file + ".values", new Uint8Array(values.buffer, values.byteOffset, values.byteLength));
  console.log(JSON.stringify({ file, ...told }));
}

for (const file of files) {
  try {
    if (file.endsWith(".h5")) {
      const transforms = await readTransformNode(file, { floatParameters: false });
      const { transformType, fixedParameters, parameters } = transforms[0];
      tell(file, parameters, { type: transformType.parametersValueType, fixed: [...fixedParameters] });
      for (const end of [".h5", ".tfm"]) await writeTransformNode(transforms, file + ".itk" + end, {});
    } else {
      const { imageType, size, origin, spacing, direction, data } = await readImageNode(file);
      tell(file, data, { type: imageType.componentType, size, origin, spacing, direction: [...direction] });
    }
  } catch (error) {
    console.log(JSON.stringify({ file, error: String(error) }));
  }
}
process.exit(0);
