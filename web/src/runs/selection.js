// The runs that are selected in the list: on all its pages, and until the page is loaded again.

export const selected = new Map(); // id -> run, as it was last seen
