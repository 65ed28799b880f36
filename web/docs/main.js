// Draws the reference from the daemon's own document.

import { init } from "redoc/bundles/redoc.standalone.js";

const fontFamily = "system-ui, sans-serif";

init(
  "/openapi.json",
  {
    disableSearch: true, // its worker would be made from text, which the page's policy forbids
    expandResponses: "200,201",
    hideDownloadButtons: true,
    jsonSamplesExpandLevel: 3,
    nativeScrollbars: true,
    sortRequiredPropsFirst: true,
    theme: { typography: { fontFamily, headings: { fontFamily } } },
  },
  document.getElementById("reference"),
);
