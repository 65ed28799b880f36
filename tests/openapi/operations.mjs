// The operations of an OpenAPI document, each as "METHOD /path/{template}".

export const operationsOf = (document) => Object.entries(document.paths).flatMap(([template, item]) =>
  ["get", "post", "put", "patch", "delete"].filter((method) => item[method] !== undefined)
    .map((method) => `${method.toUpperCase()} ${template}`));
