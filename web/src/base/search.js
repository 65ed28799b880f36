// Search in what rises in time.

// Index of the last item whose key is not after t, or -1.
export function indexBefore(items, t, key = (item) => item) {
  let low = -1;
  let high = items.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (key(items[middle]) <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}
