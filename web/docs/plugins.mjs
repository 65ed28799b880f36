// For the bundler of the reference: what Redoc's own bundle needs changed. It shows a picture of its
// makers' from their host, and nothing may come from elsewhere: it gets an empty one and shows none.
// And it asks for a module "null", which there is not: in a browser it would find nothing, too.

import { readFileSync } from "node:fs";

const picture = "https://cdn.redoc.ly/redoc/logo-mini.svg";

function withoutPicture({ path }) {
  const text = readFileSync(path, "utf8");
  if (text.split(picture).length !== 2) throw new Error(`${path} does not have ${picture} once`);
  return { contents: text.replace(picture, "data:,") };
}

function setup(build) {
  build.onLoad({ filter: /redoc\.standalone\.js$/ }, withoutPicture);
  build.onResolve({ filter: /^null$/ }, () => ({ path: "null", namespace: "nothing" }));
  build.onLoad({ filter: /./, namespace: "nothing" }, () => ({ contents: "module.exports = undefined;" }));
}

export const plugins = [{ name: "redoc", setup }];
